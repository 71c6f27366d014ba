# SPDX-License-Identifier: BSD-2-Clause
"""rtl/inputs.py and rtl/interlock.py: every pin arrives in its place, 2 clocks after it is sampled."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.inputs import InputsPeripheral
from rtl.interlock import Interlock
from tb.rtl.register_bus import idle, read

PINS = {"limit_lower": (4, 0), "limit_upper": (4, 4), "estop": (1, 8), "in0": (1, 9), "in1": (1, 10)}
"""Pin: (bits, first bit of the register)."""

LATENCY = 2


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def every_pin_has_its_place(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value = 0
    for pin in PINS:
        getattr(dut, pin).value = 0
    await FallingEdge(dut.clk)
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    rng = random.Random(seed)
    patterns = [1 << bit for bit in range(11)] + [rng.randrange(1 << 11) for _ in range(50)]
    for pattern in patterns:
        for pin, (width, shift) in PINS.items():
            getattr(dut, pin).value = pattern >> shift & ((1 << width) - 1)
        await ClockCycles(dut.clk, LATENCY, FallingEdge)
        assert await read(dut, 0) == pattern


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_level_is_readable_two_clocks_after_it_is_sampled(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value = 0
    for pin in PINS:
        getattr(dut, pin).value = 0
    await ClockCycles(dut.clk, 4, FallingEdge)
    dut.in0.value = 1
    dut.bus__addr.value, dut.bus__r_stb.value = 0, 1
    seen = []
    for _ in range(6):
        await FallingEdge(dut.clk)
        seen.append(dut.bus__r_data.value.to_unsigned() >> 9 & 1)
    # Read at the clock edge after that on which the level appeared; data 1 clock after the strobe.
    assert seen == [0] * LATENCY + [1] * (6 - LATENCY)


def test_inputs(simulate):
    simulate(InputsPeripheral(), tests="every_pin|a_level")


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def interlock_inhibits_from_reset_until_the_stop_is_seen_released(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    dut.rst.value, dut.estop.value = 1, 1
    for _ in range(3):
        await FallingEdge(dut.clk)
        assert dut.inhibit.value == 1
    dut.rst.value = 0
    for level in (1, 0, 1, 0):
        dut.estop.value = level
        before = dut.inhibit.value
        await FallingEdge(dut.clk)
        assert dut.inhibit.value == before          # sampled once
        await FallingEdge(dut.clk)
        assert dut.inhibit.value == level           # twice
        await FallingEdge(dut.clk)
        assert dut.inhibit.value == level


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def interlock_resets_to_off(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    dut.rst.value, dut.estop.value = 0, 0
    for _ in range(5):
        await FallingEdge(dut.clk)
    assert dut.inhibit.value == 0
    dut.rst.value = 1
    await FallingEdge(dut.clk)
    assert dut.inhibit.value == 1


def test_interlock(simulate):
    simulate(Interlock(), tests="interlock")
