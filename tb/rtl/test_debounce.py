# SPDX-License-Identifier: BSD-2-Clause
"""rtl/debounce.py: shows a level when it has lasted, and not before."""

import os
import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

from rtl.debounce import Debounce
from tb.models.contact import bounces, expected

WIDTH = 3
PERIODS = int(os.environ.get("PERIODS", "1"))


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def shows_what_lasts(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    rng = random.Random(seed)
    levels, level = [], 0
    while len(levels) < 6000:
        for clocks, bounce in bounces(rng, 1 - level, 4, 12):
            levels += [bounce] * clocks
        level = 1 - level
        levels += [level] * rng.randint(1, 10 * (PERIODS + 2))
    strobes = [int(rng.random() < 0.25) for _ in levels]

    dut.rst.value, dut.i.value, dut.strobe.value, dut.periods.value = 1, 0, 0, PERIODS
    await FallingEdge(dut.clk)
    dut.rst.value = 0
    seen = []
    for level, strobe in zip(levels, strobes):
        dut.i.value, dut.strobe.value = level, strobe
        seen.append(int(dut.o.value))
        await FallingEdge(dut.clk)
    seen.append(int(dut.o.value))
    want = expected(levels, strobes, PERIODS)
    assert sum(a != b for a, b in zip(want, want[1:])) > 20
    assert seen == want


@pytest.mark.parametrize("periods", [0, 1, 2, 7])
def test_debounce(simulate, periods):
    simulate(Debounce(width=WIDTH), env={"PERIODS": str(periods)})


def test_a_width_that_is_none_is_refused():
    with pytest.raises(ValueError, match="at least 1, not 0"):
        Debounce(width=0)
