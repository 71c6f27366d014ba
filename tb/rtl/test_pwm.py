# SPDX-License-Identifier: BSD-2-Clause
"""rtl/pwm.py: the pins do what the duties say, period by period, and stop at once when they must."""

import os
import random
from itertools import product

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.pwm import Pwm, PwmPeripheral
from tb.rtl import register_bus
from tb.rtl.register_bus import idle, read

PERIOD = int(os.environ.get("PERIOD", "2500"))
AXES = 4
DUTY, CONTROL, DIVIDER, STATUS, INTERRUPT, DELAY = 0x00, 0x10, 0x14, 0x18, 0x1c, 0x20
TICK, OVERRUN = 1, 2
LEAD = 1        # tick_stb comes 1 clock after the period starts, the pins 2: they lag the tick by this


class Bench:
    """Counts clocks; remembers the pins and the ticks of each.  All at falling edges."""

    def __init__(self, dut):
        self.dut, self.pins, self.ticks = dut, [], []

    async def start(self, *, divider=1, delay=0, enable=0xf):
        dut = self.dut
        seed = random.randrange(1 << 32)
        dut._log.info(f"seed {seed}")
        self.rng = random.Random(seed)
        cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
        idle(dut)
        dut.inhibit.value = dut.latched_stb.value = 0
        dut.rst.value = 1
        await ClockCycles(dut.clk, 2, FallingEdge)
        assert (dut.pwm.value, dut.dir.value, dut.motor_enable.value) == (0, 0, 0)
        dut.rst.value = 0
        cocotb.start_soon(self._record())
        await self.write(DELAY, delay)
        await self.write(DIVIDER, divider)
        await self.write(CONTROL, enable)

    async def write(self, offset, value):
        await register_bus.write(self.dut, offset, value)
        await FallingEdge(self.dut.clk)

    async def _record(self):
        while True:
            await FallingEdge(self.dut.clk)
            if self.dut.tick_stb.value:
                self.ticks.append(len(self.pins))
            self.pins.append((self.dut.pwm.value.to_unsigned(), self.dut.dir.value.to_unsigned()))

    async def tick(self):
        """Wait for the next tick, at most ten periods."""
        seen = len(self.ticks)
        for _ in range(10 * PERIOD):
            await FallingEdge(self.dut.clk)
            if len(self.ticks) > seen:
                return
        raise AssertionError("no tick")

    def period(self, number):
        """The pins of the period of tick ``number``: [(pwm, dir)] from its first clock."""
        first = self.ticks[number] + LEAD
        return self.pins[first:first + PERIOD]


def expected(duty):
    """The pins of one axis over a period."""
    on = min(abs(duty), PERIOD)
    return [1] * on + [0] * (PERIOD - on), [int(duty > 0)] * PERIOD


def axis(pins, n):
    return [pwm >> n & 1 for pwm, _ in pins], [direction >> n & 1 for _, direction in pins]


EDGE_DUTIES = [0, 1, -1, PERIOD - 1, 1 - PERIOD, PERIOD, -PERIOD, PERIOD + 1, -PERIOD - 1, 4095, -4096]


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def pins_follow_the_duties_of_the_start_of_each_period(dut):
    bench = Bench(dut)
    await bench.start()
    sets = [[duty] * AXES for duty in EDGE_DUTIES]
    sets += [[bench.rng.randint(-PERIOD, PERIOD) for _ in range(AXES)] for _ in range(len(EDGE_DUTIES))]
    await bench.tick()
    first = len(bench.ticks)
    for duties in sets:
        # Anywhere in the period before, in any order, overwritten once: only the last counts.
        await ClockCycles(dut.clk, bench.rng.randrange(PERIOD // 2 - 20) + 1, FallingEdge)
        for n in bench.rng.sample(range(AXES), AXES):
            await bench.write(DUTY + 4 * n, bench.rng.randint(-PERIOD, PERIOD))
            await bench.write(DUTY + 4 * n, duties[n])
        await bench.tick()
    await bench.tick()
    await bench.tick()
    for number, duties in enumerate(sets, first):
        for n, duty in enumerate(duties):
            assert axis(bench.period(number), n) == expected(duty), (number, n, duty)
    assert await read(dut, DUTY) == sets[-1][0] & 0x1fff


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(divider=[4], delay=[0, 1, 2, 3, 4, 9])
async def duties_are_driven_a_constant_time_after_their_tick(dut, divider, delay):
    """Written at any moment before, by a processor as late as it likes, they come at one PWM period."""
    bench = Bench(dut)
    await bench.start(divider=divider, delay=delay)
    periods = delay if 0 < delay <= divider else divider
    sets = [[bench.rng.randint(-PERIOD, PERIOD) for _ in range(AXES)] for _ in range(6)]
    await bench.tick()                                      # delay is taken here
    await bench.tick()
    first = len(bench.ticks) - 1
    for duties in sets:
        await ClockCycles(dut.clk, 1 + bench.rng.randrange(periods * PERIOD - 30), FallingEdge)
        for n in bench.rng.sample(range(AXES), AXES):
            await bench.write(DUTY + 4 * n, duties[n])
        await bench.tick()
    await bench.tick()
    await bench.tick()
    for number, (before, duties) in enumerate(zip(sets, sets[1:]), first + 1):
        for period in range(divider):
            # Up to the period at which they are taken the duties of the tick before hold.
            start = bench.ticks[number] + LEAD + period * PERIOD
            due = duties if period >= periods else before
            for n in range(AXES):
                assert axis(bench.pins[start:start + PERIOD], n) == expected(due[n]), (number, period, n)


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def without_ticks_duties_are_taken_at_every_period(dut):
    bench = Bench(dut)
    await bench.start(divider=0, delay=2)
    for duty in (PERIOD, 0, PERIOD, 0):
        await bench.write(DUTY, duty)
        await ClockCycles(dut.clk, 2 * PERIOD, FallingEdge)
        assert dut.pwm.value[0] == (duty != 0)


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_period_is_as_long_as_promised(dut):
    bench = Bench(dut)
    await bench.start()
    for _ in range(5):
        await bench.tick()
    assert [b - a for a, b in zip(bench.ticks, bench.ticks[1:])] == [PERIOD] * (len(bench.ticks) - 1)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def off_is_at_once_and_on_is_with_the_next_period(dut):
    bench = Bench(dut)
    await bench.start()
    for n, duty in enumerate((PERIOD, -PERIOD, PERIOD - 3, -(PERIOD // 2))):
        await bench.write(DUTY + 4 * n, duty)
    await bench.tick()
    # Every phase of the period at which the release can come, of both causes, where that is quick.
    phases = range(2 * PERIOD) if PERIOD < 100 else bench.rng.sample(range(2 * PERIOD), 6)
    for phase, cause in product(phases, ["inhibit", "enable"]):
        await bench.tick()
        await ClockCycles(dut.clk, 2 + phase // 3 % (PERIOD // 2 - 8), FallingEdge)
        before = dut.dir.value
        assert dut.pwm.value == 0xf and dut.motor_enable.value == 1
        if cause == "inhibit":
            dut.inhibit.value = 0xf
        else:
            await register_bus.write(dut, CONTROL, 0)
            await FallingEdge(dut.clk)                      # the register holds it from here
        await FallingEdge(dut.clk)
        assert dut.pwm.value == 0 and dut.dir.value == before       # 1 clock later
        assert dut.motor_enable.value == 0
        off_at = len(bench.pins)
        if cause == "inhibit":
            assert await read(dut, STATUS) == 0xf
        await ClockCycles(dut.clk, 1 + phase, FallingEdge)
        if cause == "inhibit":
            dut.inhibit.value = 0
        else:
            await bench.write(CONTROL, 0xf)
        on_at = len(bench.pins)
        await bench.tick()
        if bench.ticks[-1] - LEAD < on_at:                          # its period had started before
            await bench.tick()
        await ClockCycles(dut.clk, 4, FallingEdge)
        start = bench.ticks[-1] + LEAD
        assert {pwm for pwm, _ in bench.pins[off_at:start]} == {0}
        assert {pwm for pwm, _ in bench.pins[start:]} == {0xf}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_axis_released_is_not_driven_by_a_duty_from_before(dut):
    """Off, its duty set to 0, and on again within one servo period: nothing may be left of the old duty."""
    bench = Bench(dut)
    await bench.start(divider=4, delay=2)
    for cause in ["inhibit", "enable"] * 2:
        for duty in (PERIOD, 0):
            await bench.write(DUTY, duty)
            for _ in range(2):
                await bench.tick()
            assert dut.pwm.value[0] == 0 or duty          # still driven by the duty of the first pass
            if duty:
                await ClockCycles(dut.clk, bench.rng.randrange(2, 4 * PERIOD - 60), FallingEdge)
                assert dut.pwm.value == 1
                if cause == "inhibit":
                    dut.inhibit.value = 0xf
                else:
                    await bench.write(CONTROL, 0)
                await ClockCycles(dut.clk, 2, FallingEdge)
                off_at = len(bench.pins)
                await bench.write(DUTY, 0)
                if cause == "inhibit":
                    dut.inhibit.value = 0
                else:
                    await bench.write(CONTROL, 0xf)
                await ClockCycles(dut.clk, 8 * PERIOD, FallingEdge)
                assert {pwm for pwm, _ in bench.pins[off_at:]} == {0}


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def ticks_and_duties_follow_their_registers_however_they_change(dut):
    """Divider, delay and duty are written anew in every period; a reference in times says what must come."""
    bench = Bench(dut)
    await bench.start(divider=1)
    await bench.tick()
    base, periods = len(bench.ticks) - 1, 400 if PERIOD < 100 else 60
    first = bench.ticks[base]
    rng, registers = bench.rng, []
    divider, delay, duty = 1, 0, 0
    for _ in range(periods):
        await ClockCycles(dut.clk, rng.randrange(1, PERIOD // 4), FallingEdge)
        if rng.random() < 0.4:
            divider = rng.choice([0, 0, 1, 2, 3, 5])
            await bench.write(DIVIDER, divider)
        if rng.random() < 0.4:
            delay = rng.choice([0, 1, 2, 3, 4, 255])
            await bench.write(DELAY, delay)
        duty = rng.randrange(PERIOD + 1)
        await bench.write(DUTY, duty)
        registers.append((divider, delay, duty))
        while (len(bench.pins) - first) % PERIOD:
            await FallingEdge(dut.clk)
    await ClockCycles(dut.clk, 2 * PERIOD, FallingEdge)

    # Period n + 1 starts with the registers as written in period n.  The tick of period 0 took divider 1, delay 0.
    last_tick, ticks_every, taken_after, taken, driven = 0, 1, 0, False, 0
    for start, (divider, delay, duty) in enumerate(registers, 1):
        free = start >= last_tick + ticks_every
        tick, stopped = free and divider > 0, free and divider == 0
        if stopped or not taken and (tick or start == last_tick + taken_after):
            driven, taken = duty, True
        if tick:
            last_tick, ticks_every, taken_after, taken = start, divider, delay, False
        clock = first + start * PERIOD
        assert (clock in bench.ticks) == tick, start
        pins = bench.pins[clock + LEAD:clock + LEAD + PERIOD]
        assert [pwm & 1 for pwm, _ in pins] == [1] * driven + [0] * (PERIOD - driven), (start, driven)


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def one_axis_is_disabled_alone(dut):
    bench = Bench(dut)
    await bench.start()
    for n in range(AXES):
        await bench.write(DUTY + 4 * n, PERIOD)
    for n in range(AXES):
        await bench.write(CONTROL, 0xf & ~(1 << n))
        await bench.tick()
        await bench.tick()
        assert dut.pwm.value == 0xf & ~(1 << n) and dut.motor_enable.value == 1
        assert await read(dut, STATUS) == (0xf & ~(1 << n)) << 4


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def ticks_are_a_division_of_the_period(dut):
    bench = Bench(dut)
    await bench.start(divider=3)
    for divider in (1, 2, 4, 7):
        await bench.write(DIVIDER, divider)
        first = len(bench.ticks)
        while len(bench.ticks) < first + 4:
            await FallingEdge(dut.clk)
        ticks = bench.ticks[first:]
        assert [b - a for a, b in zip(ticks, ticks[1:])] == [divider * PERIOD] * 3
    await bench.write(DIVIDER, 0)
    seen = len(bench.ticks)
    await ClockCycles(dut.clk, 9 * PERIOD, FallingEdge)
    assert len(bench.ticks) == seen
    await bench.write(DIVIDER, 5)
    await bench.tick()                                      # at once, not after 5 periods


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def interrupts_when_the_snapshot_is_ready_and_tells_when_that_was_too_late(dut):
    bench = Bench(dut)
    await bench.start()

    async def latch():
        assert dut.interrupt.value == 0
        await ClockCycles(dut.clk, bench.rng.randrange(1, 12), FallingEdge)
        dut.latched_stb.value = 1
        assert dut.interrupt.value == 0
        await FallingEdge(dut.clk)
        dut.latched_stb.value = 0
        assert dut.interrupt.value == 1                     # 1 clock after

    await bench.tick()
    await latch()
    await ClockCycles(dut.clk, PERIOD // 2, FallingEdge)
    assert dut.interrupt.value == 1                         # holds
    await bench.write(INTERRUPT, TICK)
    assert dut.interrupt.value == 0
    await bench.tick()
    await latch()
    assert await read(dut, INTERRUPT) == TICK               # in time: no overrun
    await bench.tick()                                      # not acknowledged before this one
    await FallingEdge(dut.clk)
    assert await read(dut, INTERRUPT) == TICK | OVERRUN
    await bench.write(INTERRUPT, TICK)
    assert dut.interrupt.value == 0                         # overrun alone does not interrupt
    assert await read(dut, INTERRUPT) == OVERRUN
    await bench.write(INTERRUPT, OVERRUN)
    assert await read(dut, INTERRUPT) == 0


@pytest.mark.parametrize("period", [60, 2500])
def test_pwm(simulate, period):
    simulate(PwmPeripheral(period_clocks=period), env={"PERIOD": str(period)})


@pytest.mark.parametrize("period", [1, 4096])
def test_a_period_that_does_not_fit_is_refused(period):
    with pytest.raises(ValueError, match="2 to 4095"):
        Pwm(period_clocks=period)
