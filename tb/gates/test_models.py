# SPDX-License-Identifier: BSD-2-Clause
"""tb/gates/models: block memory and multiplier do what the source says of which yosys made them."""

import random
import re
import sys

import cocotb
import pytest
from cocotb.triggers import Timer

from tb import verilated
from tb.gates import inferred

pytestmark = pytest.mark.gates

INPUTS = {name: bits for name, bits in inferred.INPUTS.items() if name != "clk"}


async def clock(dut, **inputs):
    """One clock with these inputs, the others 0; fails if any shape shows something else than its source."""
    for name in INPUTS:
        getattr(dut, name).value = inputs.get(name, 0)
    for level in 0, 1:
        await Timer(5, unit="ns")
        wrong = dut.wrong.value.to_unsigned()
        assert not wrong, [shape.name for n, shape in enumerate(inferred.SHAPES) if wrong >> n & 1]
        dut.clk.value = level
    await Timer(1, unit="ns")


@cocotb.test()
async def initial_contents_are_read_at_either_port(dut):
    dut.clk.value = 0
    await clock(dut)
    for address in range(2**14):
        await clock(dut, a_enable=1, b_enable=1, a_address=address, b_address=2**14 - 1 - address)
    await clock(dut)


@cocotb.test()
async def random_reads_and_writes_of_bytes_agree(dut):
    rng = random.Random(1)
    dut.clk.value = 0
    clashed = 0
    for n in range(12000):
        # Few addresses, in all rows and columns, so that what was written is read, and sometimes at once.
        inputs = {name: rng.getrandbits(bits) for name, bits in INPUTS.items()}
        for port in "ab":
            inputs[f"{port}_address"] = rng.choice((rng.randrange(16), rng.randrange(4) << 12 | rng.randrange(16)))
            inputs[f"{port}_enable"] = rng.random() < 0.8
            inputs[f"{port}_write"] &= -(rng.random() < 0.5)
        if inputs["a_write"] and inputs["b_write"]:
            inputs[rng.choice(("a_write", "b_write"))] = 0
        await clock(dut, **inputs)
        clashed |= dut.clash.value.to_unsigned()
    await clock(dut)
    # And a port that read what the other was writing got neither the old word nor the new one.
    for n, shape in enumerate(inferred.SHAPES):
        assert (clashed >> n & 1) == (shape.template in inferred.MAY_CLASH), shape.name


@cocotb.test()
async def products_agree_at_the_ends_of_their_ranges(dut):
    dut.clk.value = 0
    ends = {0, 1, 2, *(value for bits in (17, 18, 32) for power in (bits - 1, bits)
                       for value in (2**power - 1, 2**power, 2**power + 1))}
    for a in ends:
        for b in ends:
            await clock(dut, a_data=a, b_data=b)


def test_inferred_blocks():
    """And all widths that the model of the memory knows have been there."""
    directory = inferred.build(random.Random(7))
    assert not verilated.failures(directory, sys.modules[__name__], label="models")
    widths = set(re.findall(r"\.DATA_WIDTH_A\(32'[sd]*(\d+)\)", (directory / "gates.netlist.v").read_text()))
    assert widths == {"1", "2", "4", "9", "18", "36"}
