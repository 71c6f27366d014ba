# SPDX-License-Identifier: BSD-2-Clause
"""rtl/quadrature.py: the registers of an encoder axis, over the bus."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
from cocotb.utils import get_sim_time

from tb.rtl.register_bus import idle, read, write
from rtl.quadrature import QuadraturePeripheral
from tb.models.encoder import CIRCLE

CONFIG, STATUS, ERRORS, INDEX = 0x0, 0x4, 0x8, 0xc
ERROR_BIT, INDEX_BIT = 1, 2


class Axis:
    """The axis under test, its pins moved by hand: slow against ``fast``."""

    def __init__(self, dut):
        self.dut, self.place = dut, 0

    async def start(self, phase=0):
        dut = self.dut
        idle(dut)
        for pin in dut.a, dut.b, dut.z, dut.sample:
            pin.value = 0
        dut.rst.value = dut.fast_rst.value = 1
        cocotb.start_soon(Clock(dut.clk, 20000, unit="ps").start())
        await Timer(phase + 1, unit="ps")
        cocotb.start_soon(Clock(dut.fast_clk, 5000, unit="ps").start())
        await ClockCycles(dut.clk, 8, FallingEdge)
        dut.rst.value = dut.fast_rst.value = 0
        await ClockCycles(dut.clk, 8, FallingEdge)

    async def step(self, direction, clocks=20):
        self.place = (self.place + direction) % 4
        await Timer(777, unit="ps")
        self.dut.a.value, self.dut.b.value = (int(level) for level in CIRCLE[self.place])
        await ClockCycles(self.dut.fast_clk, clocks)

    async def jump(self):
        """An illegal transition."""
        await self.step(2)

    async def pulse(self, pin, clocks):
        pin.value = 1
        await ClockCycles(self.dut.fast_clk, clocks)
        pin.value = 0
        await ClockCycles(self.dut.fast_clk, 20)

    async def sample(self):
        """The snapshot's strobe: one ``fast`` clock."""
        await FallingEdge(self.dut.fast_clk)
        self.dut.sample.value = 1
        await FallingEdge(self.dut.fast_clk)
        self.dut.sample.value = 0

    async def on_bus(self, operation, *arguments, **options):
        await FallingEdge(self.dut.clk)
        return await operation(self.dut, *arguments, **options)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(phase=[0, 1234])
async def config_reads_back_and_reaches_the_decoder(dut, phase):
    axis = Axis(dut)
    await axis.start(phase)
    assert await axis.on_bus(read, CONFIG) == 0
    await axis.on_bus(write, CONFIG, 0x15)              # filter 5, inverted
    assert await axis.on_bus(read, CONFIG) == 0x15
    await ClockCycles(dut.clk, 6)
    await axis.step(1)
    assert dut.steps__count.value.to_signed() == -1
    # A is high now.  Low for 5 samples is a glitch, for 6 it is a step and a step back.
    for clocks, steps in (5, 0), (6, 2):
        await FallingEdge(dut.fast_clk)
        dut.a.value = 0
        await ClockCycles(dut.fast_clk, clocks, FallingEdge)
        dut.a.value = 1
        for _ in range(20):
            steps -= int(dut.steps__moved.value)
            await FallingEdge(dut.fast_clk)
        assert steps == 0 and dut.steps__count.value.to_signed() == -1


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(phase=[0, 999, 4321])
async def config_is_taken_over_within_6_clocks(dut, phase):
    axis = Axis(dut)
    await axis.start(phase)
    # Steps of two clocks: seen one by one without filter, none of them with it.
    async def shake():
        while True:
            dut.a.value = 1 - int(dut.a.value)
            await Timer(10001, unit="ps")
    cocotb.start_soon(shake())
    await ClockCycles(dut.clk, 4, FallingEdge)
    await write(dut, CONFIG, 15)
    await ClockCycles(dut.clk, 5, FallingEdge)          # with the clock of the write: 6
    await ClockCycles(dut.fast_clk, 3, FallingEdge)     # a step judged before is still under way
    still = dut.steps__count.value.to_signed()
    for _ in range(100):
        await FallingEdge(dut.fast_clk)
        assert dut.steps__count.value.to_signed() == still


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def the_last_of_several_writes_holds(dut):
    axis = Axis(dut)
    await axis.start()
    for value in 0x1f, 0x0f, 0x10, 0x03, 0x1f, 0x10:
        await axis.on_bus(write, CONFIG, value)
    await ClockCycles(dut.clk, 12)
    await axis.step(1)
    assert dut.steps__count.value.to_signed() == -1


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def status_says_what_happened_until_it_is_cleared(dut):
    axis = Axis(dut)
    await axis.start()
    await axis.step(1)
    assert await axis.on_bus(read, STATUS) == 0
    await axis.jump()
    await ClockCycles(dut.clk, 6)
    assert await axis.on_bus(read, STATUS) == ERROR_BIT
    await axis.pulse(dut.z, 4)
    await ClockCycles(dut.clk, 6)
    assert await axis.on_bus(read, STATUS) == ERROR_BIT | INDEX_BIT
    await axis.on_bus(write, STATUS, ERROR_BIT)
    await ClockCycles(dut.clk, 2)
    assert await axis.on_bus(read, STATUS) == INDEX_BIT
    await axis.on_bus(write, STATUS, INDEX_BIT)
    await ClockCycles(dut.clk, 2)
    assert await axis.on_bus(read, STATUS) == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_burst_of_errors_is_not_missed(dut):
    axis = Axis(dut)
    await axis.start()
    for _ in range(50):
        dut.a.value, dut.b.value = 1 - int(dut.a.value), 1 - int(dut.b.value)
        await Timer(5000, unit="ps")
    await ClockCycles(dut.clk, 10)
    assert await axis.on_bus(read, STATUS) == ERROR_BIT
    await axis.sample()
    await ClockCycles(dut.clk, 2)
    assert await axis.on_bus(read, ERRORS) == 50


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def diagnostics_are_those_of_the_sample(dut):
    axis = Axis(dut)
    await axis.start()
    rng = random.Random(3)
    count = errors = 0
    for _ in range(12):
        direction = rng.choice([1, -1])
        for _ in range(rng.randrange(1, 6)):
            await axis.step(direction)
            count += direction
        await axis.pulse(dut.z, 3)
        if rng.random() < 0.5:
            await axis.jump()
            errors += 1
        await axis.sample()
        kept = count, errors
        # What happens after the sample shows at the next.
        await axis.step(direction)
        count += direction
        await axis.pulse(dut.z, 3)
        await axis.jump()
        errors += 1
        assert (await axis.on_bus(read, INDEX, signed=True), await axis.on_bus(read, ERRORS)) == kept


def test_registers(simulate):
    simulate(QuadraturePeripheral())


def test_registers_with_late_synchronisers(simulate):
    # Not those that move A and B at once, or count samples: a synchroniser may now move either by a clock.
    simulate(QuadraturePeripheral(), random_delay=True, tests="config_is_taken_over|the_last_of_several")
