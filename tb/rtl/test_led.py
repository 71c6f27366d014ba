# SPDX-License-Identifier: BSD-2-Clause
"""rtl/led.py: every period is whole, for every share of light and whenever it is changed, to the clock."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer, ValueChange
from cocotb.utils import get_sim_time

from rtl.led import LEAD_CLOCKS, LENGTH_BITS, PERIOD_RESET, LedPeripheral, LedPwm
from tb.rtl.register_bus import idle, read, write

FAST_PS = 5000
PERIOD, ON, CONTROL, STATUS = 0x0, 0x4, 0x8, 0xc
FIRST = LEAD_CLOCKS                     # clocks from reset to the first period
ARRIVAL_PS = 110_000                    # from the end of the write to what can be a period with it


def packed(period, on):
    return period - LEAD_CLOCKS | on << LENGTH_BITS | (on != 0) << 2 * LENGTH_BITS


def any_settings(random_):
    period = random_.choice([4, 5, 6, 7, 20, 255, 256, 257, 258, 259, 260, 300, 515])
    return period, random_.choice([0, 1, 2, period - 1, period, random_.randint(0, period)])


async def run(dut, settings, clocks):
    """Levels of that many clocks after reset; ``settings(clock)`` is on the input in each."""
    cocotb.start_soon(Clock(dut.fast_clk, FAST_PS, unit="ps").start())
    dut.fast_rst.value, dut.settings.value = 1, packed(*settings(0))
    await FallingEdge(dut.fast_clk)
    dut.fast_rst.value = 0
    levels = []
    for clock in range(clocks):
        dut.settings.value = packed(*settings(clock))
        await RisingEdge(dut.fast_clk)
        levels.append(int(dut.level.value))
        await FallingEdge(dut.fast_clk)
    return levels


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(seed=range(6))
async def a_period_is_what_was_set_three_clocks_before_it(dut, seed):
    random_, clocks = random.Random(seed), 6000
    rarely = random_.choice([0.5, 0.01, 0.001])
    offered = [any_settings(random_)]
    for _ in range(clocks):
        offered.append(any_settings(random_) if random_.random() < rarely else offered[-1])
    levels = await run(dut, offered.__getitem__, clocks)
    expected, begin = [0] * FIRST, FIRST
    while begin < clocks:
        period, on = offered[begin - LEAD_CLOCKS]
        light = (clock for clock in range(begin, begin + period - LEAD_CLOCKS) if offered[clock][1])
        if not on and (first := next(light, None)) is not None:
            period = first + 1 + LEAD_CLOCKS - begin
        expected += [1] * on + [0] * (period - on)
        begin += period
    wrong = [clock for clock in range(clocks) if levels[clock] != expected[clock]]
    assert not wrong, f"seed {seed}: clock {wrong[0]}, first of {len(wrong)}"
    assert 0.1 < sum(levels) / clocks < 0.95


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(period=[4, 5, 200, 256, 1000])
async def never_high_and_never_low_are_exact(dut, period):
    levels = await run(dut, lambda clock: (period, period if clock < 5 * period else 0), 10 * period)
    rises = [n for n in range(1, len(levels)) if levels[n] and not levels[n - 1]]
    falls = [n for n in range(1, len(levels)) if levels[n - 1] and not levels[n]]
    assert (rises, len(falls), (falls[0] - FIRST) % period) == ([FIRST], 1, 0)


class Lamp:
    """The registers, and the edges at the pin."""

    def __init__(self, dut):
        self.dut, self.edges = dut, []

    async def start(self):
        # They drift against each other by a few ps: nothing may lean on their phase.
        cocotb.start_soon(Clock(self.dut.clk, 19998, unit="ps").start())
        cocotb.start_soon(Clock(self.dut.fast_clk, FAST_PS, unit="ps").start())
        idle(self.dut)
        self.dut.rst.value = self.dut.fast_rst.value = 1
        await Timer(100, unit="ns")
        self.dut.rst.value = self.dut.fast_rst.value = 0
        await Timer(100, unit="ns")
        await FallingEdge(self.dut.clk)
        cocotb.start_soon(self._record())

    async def _record(self):
        while True:
            await ValueChange(self.dut.light)
            self.edges.append((int(get_sim_time("ps")), int(self.dut.light.value)))

    async def light(self, period, on):
        """Returns the time at which the write of ``load`` ends."""
        for register, value in (PERIOD, period), (ON, on), (CONTROL, 1):
            await write(self.dut, register, value)
        return int(get_sim_time("ps"))

    async def wait(self):
        for _ in range(20):
            if not await read(self.dut, STATUS):
                return
            await FallingEdge(self.dut.clk)
        raise AssertionError("busy for ever")

    def periods(self):
        """``[(begin, length, high)]`` in ps and fast clocks, of those that are over."""
        rises = [time for time, level in self.edges if level]
        falls = [time for time, level in self.edges if not level]
        return [(rise, (following - rise) / FAST_PS, (fall - rise) / FAST_PS)
                for rise, fall, following in zip(rises, falls, rises[1:])]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(seed=range(5))
async def length_and_share_change_together_between_two_periods(dut, seed):
    random_, lamp = random.Random(seed), Lamp(dut)
    await lamp.start()
    told = [(300, 100)]
    loaded = [await lamp.light(*told[0])]
    for _ in range(40):
        await Timer(random_.randrange(3 * 600 * FAST_PS), unit="ps")
        await FallingEdge(dut.clk)
        period = random_.choice([5, 77, 256, 600])
        told.append((period, random_.randrange(1, period)))
        loaded.append(await lamp.light(*told[-1]))
        await lamp.wait()
    await Timer(20, unit="us")
    seen = lamp.periods()
    for number, (begin, *period) in enumerate(seen[:-1]):
        # That of the last load that had arrived, or of the one behind it, which was just arriving.
        arrived = sum(time + ARRIVAL_PS <= begin for time in loaded)
        under_way = sum(time <= begin for time in loaded)
        assert tuple(period) in told[max(arrived - 1, 0):under_way], f"seed {seed}: period {number} is {period}"
    assert len({tuple(period) for _, *period in seen}) > 30


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def loads_without_a_wait_leave_nothing_half(dut):
    """Period and On are written together, and loaded again before the load before has arrived."""
    lamp = Lamp(dut)
    await lamp.start()
    for n in range(200):
        await lamp.light(*((40, 10), (60, 30))[n % 2])
    assert await read(dut, STATUS) == 1
    await lamp.wait()
    await Timer(2, unit="us")
    assert {tuple(period) for _, *period in lamp.periods()[1:]} == {(40, 10), (60, 30)}
    assert tuple(lamp.periods()[-1][1:]) == (60, 30)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def settings_out_of_range_are_the_next_in_it(dut):
    lamp = Lamp(dut)
    await lamp.start()
    assert (await read(dut, PERIOD), await read(dut, ON), await read(dut, STATUS)) == (PERIOD_RESET, 0, 0)
    await Timer(1, unit="us")
    assert not lamp.edges
    await lamp.light(0, 1)
    await Timer(1, unit="us")
    assert {tuple(period) for _, *period in lamp.periods()} == {(4, 1)}
    await FallingEdge(dut.clk)
    await lamp.light(10, (1 << LENGTH_BITS) - 1)        # all of it, and no more once it is told otherwise
    await Timer(1, unit="us")
    before = len(lamp.edges)
    await Timer(1, unit="us")
    assert len(lamp.edges) == before and lamp.edges[-1][1] == 1
    await FallingEdge(dut.clk)
    await lamp.light(10, 0)
    await Timer(1, unit="us")
    assert len(lamp.edges) == before + 1 and lamp.edges[-1][1] == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(hz=[1300, 10_000, 200_000])
async def the_frequency_is_the_clock_over_the_period(dut, hz):
    lamp, period = Lamp(dut), round(200e6 / hz)
    await lamp.start()
    told = await lamp.light(period, period // 4)
    await Timer(4 * period * FAST_PS, unit="ps")
    assert told <= lamp.edges[0][0] <= told + ARRIVAL_PS        # from dark at once
    assert {tuple(seen) for _, *seen in lamp.periods()} == {(period, period // 4)}


def test_pwm(simulate):
    simulate(LedPwm(), tests="three_clocks|exact")


def test_peripheral(simulate):
    simulate(LedPeripheral(), random_delay=True, tests="together|half|next_in_it|over_the_period")
