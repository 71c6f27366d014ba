# SPDX-License-Identifier: BSD-2-Clause
"""rtl/inputs.py: every pin arrives in its place, 2 clocks after it is sampled; edges are kept."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.inputs import InputsPeripheral
from tb.rtl.register_bus import idle, read, write

PINS = {"limit_lower": (4, 0), "limit_upper": (4, 4), "estop": (1, 8), "in0": (1, 9), "in1": (1, 10),
        "dip": (4, 11)}
"""Pin: (bits, first bit of the register)."""

BITS = 15
EDGES, TIMES = 0x4, {"in0": 0x8, "in1": 0xc}

LATENCY = 2


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def every_pin_has_its_place(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value, dut.count.value = 0, 0
    for pin in PINS:
        getattr(dut, pin).value = 0
    await FallingEdge(dut.clk)
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    rng = random.Random(seed)
    patterns = [1 << bit for bit in range(BITS)] + [rng.randrange(1 << BITS) for _ in range(50)]
    for pattern in patterns:
        for pin, (width, shift) in PINS.items():
            getattr(dut, pin).value = pattern >> shift & ((1 << width) - 1)
        await ClockCycles(dut.clk, LATENCY, FallingEdge)
        assert await read(dut, 0) == pattern


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_level_is_readable_two_clocks_after_it_is_sampled(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value, dut.count.value = 0, 0
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


async def start(dut):
    """All pins and the time at 0, one clock in reset."""
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value = 1
    for pin in PINS:
        getattr(dut, pin).value = 0
    dut.count.value = 0
    await FallingEdge(dut.clk)
    dut.rst.value = 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def edges_are_kept_and_stamped(dut):
    """A random walk of the two TTL inputs, cleared now and then; the reference remembers what was done."""
    await start(dut)
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    rng = random.Random(seed)
    now, level, kept, at = 0, {"in0": 0, "in1": 0}, 0, {"in0": 0, "in1": 0}

    async def clocks(count):
        nonlocal now
        for _ in range(count):
            now += 1
            dut.count.value = now
            await FallingEdge(dut.clk)

    for _ in range(300):
        for _ in range(rng.randrange(4)):
            pin = rng.choice(["in0", "in1"])
            level[pin] = 1 - level[pin]
            getattr(dut, pin).value = level[pin]
            at[pin] = now + 1 + LATENCY                 # the clock on which the level is readable
            kept |= (1 if level[pin] else 2) << (0 if pin == "in0" else 2)
            await clocks(rng.randint(1, 3))
        await clocks(LATENCY + 1)
        assert await read(dut, EDGES) == kept
        for pin, offset in TIMES.items():
            assert await read(dut, offset) == at[pin]
        if rng.random() < 0.5:
            cleared = rng.randrange(16)
            await write(dut, EDGES, cleared)
            kept &= ~cleared
            await clocks(1)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_pulse_of_one_clock_is_both_edges(dut):
    await start(dut)
    dut.in1.value = 1
    await FallingEdge(dut.clk)
    dut.in1.value = 0
    await ClockCycles(dut.clk, LATENCY + 1, FallingEdge)
    assert await read(dut, EDGES) == 0xc


def test_inputs(simulate):
    simulate(InputsPeripheral())
