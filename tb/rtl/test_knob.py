# SPDX-License-Identifier: BSD-2-Clause
"""rtl/knob.py: hand-wheels are counted edge by edge, bouncing or not, and each by itself."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.knob import KnobPeripheral
from tb.models.encoder import CIRCLE
from tb.rtl.register_bus import idle, read, write

POSITION, FILTER, ERRORS = 0x00, 0x10, 0x14
UNIT = 64                               # clocks, of the filter
LATENCY = 2 + 2                         # synchroniser, debouncer and count


class Wheel:
    """A hand on a wheel: walks along the circle of A and B."""

    def __init__(self, dut, n, rng):
        self.dut, self.n, self.rng, self.place = dut, n, rng, 0

    def put(self, a, b):
        for pin, level in (self.dut.a, a), (self.dut.b, b):
            pin.value = pin.value.to_unsigned() & ~(1 << self.n) | int(level) << self.n

    async def step(self, direction, *, clocks, bounces=0, longest=1):
        """One edge, after some bounces of the one contact that moves, then some rest."""
        before, after = (CIRCLE[place % 4] for place in (self.place, self.place + direction))
        for _ in range(bounces):
            for levels in after, before:
                self.put(*levels)
                await ClockCycles(self.dut.clk, self.rng.randint(1, longest), FallingEdge)
        self.put(*after)
        self.place += direction
        await ClockCycles(self.dut.clk, clocks, FallingEdge)


async def start(dut, periods):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value, dut.a.value, dut.b.value = 1, 0, 0
    await FallingEdge(dut.clk)
    dut.rst.value = 0
    await FallingEdge(dut.clk)
    assert await read(dut, FILTER) == 40
    await write(dut, FILTER, periods)
    await FallingEdge(dut.clk)
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    return random.Random(seed)


def signed16(value):
    return (value ^ 0x8000) - 0x8000


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(periods=[0, 1, 3])
async def counts_every_edge_that_lasts_however_it_bounces(dut, periods):
    rng = await start(dut, periods)
    wheels = [Wheel(dut, n, rng) for n in range(3)]
    lasts = max(periods, 1) * UNIT + LATENCY
    for _ in range(150):
        wheel = rng.choice(wheels)
        bounces = rng.randrange(4) if periods > 1 else 0
        await wheel.step(rng.choice([1, 1, -1]), clocks=lasts, bounces=bounces, longest=UNIT // 2)
        for other in wheels:
            assert signed16(await read(dut, POSITION + 4 * other.n)) == other.place
    assert await read(dut, ERRORS) == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_count_wraps_both_ways(dut):
    rng = await start(dut, 0)
    wheel = Wheel(dut, 0, rng)
    await wheel.step(-1, clocks=UNIT + LATENCY)
    assert await read(dut, POSITION) & 0xffff == 0xffff
    await wheel.step(1, clocks=UNIT + LATENCY)
    assert await read(dut, POSITION) == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_glitch_is_not_counted(dut):
    rng = await start(dut, 4)
    for _ in range(50):
        pin, bit = rng.choice([dut.a, dut.b]), 1 << rng.randrange(3)
        pin.value = bit
        await ClockCycles(dut.clk, rng.randint(1, 3 * UNIT), FallingEdge)
        pin.value = 0
        await ClockCycles(dut.clk, rng.randint(1, 2 * UNIT), FallingEdge)
    assert [await read(dut, POSITION + 4 * n) for n in range(3)] == [0, 0, 0]
    assert await read(dut, ERRORS) == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def both_channels_at_once_are_told_and_not_counted(dut):
    await start(dut, 1)
    dut.a.value, dut.b.value = 2, 2
    await ClockCycles(dut.clk, UNIT + LATENCY, FallingEdge)
    assert await read(dut, POSITION + 4) == 0
    assert await read(dut, ERRORS) == 2
    await write(dut, ERRORS, 2)
    await FallingEdge(dut.clk)
    assert await read(dut, ERRORS) == 0


def test_knob(simulate):
    simulate(KnobPeripheral())
