# SPDX-License-Identifier: BSD-2-Clause
"""rtl/interlock.py and rtl/monitor.py: each fault holds its axis off in time, is kept, and is cleared when it may be.

The counts come from the bench as a decoder's would, one step a ``fast`` clock at most; drives are what the bench says.
"""

import os
import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.interlock import InterlockPeripheral
from rtl.monitor import MEAN_WINDOWS, SAMPLE_CLOCKS, WINDOW_SAMPLES
from tb.rtl.register_bus import idle, read, write

LATE = int(os.environ.get("LATE", "0"))             # 1: synchronisers may take one clock more
AXES = 4

FAULTS, CAUSES, CLEAR, CONTROL, WAY, STRONG, DRIVE_TIME, HELD_MOST, ILLEGAL_MOST, ILLEGAL_TIME = range(0, 40, 4)
STRONG_TIME, BREAKAWAY, SPEED_MOST, FOLLOWING_MOST, EXPECTED = 0x30, 0x40, 0x50, 0x60, 0x70
ILLEGAL, NO_PROGRESS, OVER_SPEED, FOLLOWING = 0, 4, 8, 12       # first bits of the fields
WATCHDOG, ESTOP = 1 << 16, 1 << 17

SAMPLE_AGE = 9                  # clocks from a count to what a detector says of it, a late synchroniser included
RESET = {WAY: 2, STRONG: 1250, STRONG_TIME: 1920, DRIVE_TIME: 38000, HELD_MOST: 1750, ILLEGAL_MOST: 0, ILLEGAL_TIME: 100,
         CONTROL: 0, BREAKAWAY: 380, SPEED_MOST: 70, FOLLOWING_MOST: 0, EXPECTED: 0}


class Bench:
    def __init__(self, dut):
        self.dut, self.counts = dut, [0] * AXES

    async def start(self):
        dut = self.dut
        seed = random.randrange(1 << 32)
        dut._log.info(f"seed {seed}")
        self.rng = random.Random(seed)
        cocotb.start_soon(Clock(dut.fast_clk, 5, unit="ns").start())
        cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
        idle(dut)
        for pin in dut.estop, dut.expired, dut.illegal:
            pin.value = 0
        for axis in range(AXES):
            self.drive(axis, 0)
            self._show(axis)
        dut.rst.value = dut.fast_rst.value = 1
        await ClockCycles(dut.clk, 4, FallingEdge)
        assert LATE or dut.inhibit.value == 0xf         # until the stop has been seen released
        dut.rst.value = dut.fast_rst.value = 0
        await ClockCycles(dut.clk, 4 + LATE, FallingEdge)
        assert dut.inhibit.value == 0
        await self.clear(~0)

    def drive(self, axis, steps):
        getattr(self.dut, f"drive__{axis}").value = steps

    def _show(self, axis):
        getattr(self.dut, f"low__{axis}").value = self.counts[axis] & 0xff

    async def step(self, axis, by):
        """One count a ``fast`` clock."""
        for _ in range(abs(by)):
            await FallingEdge(self.dut.fast_clk)
            self.counts[axis] += 1 if by > 0 else -1
            self._show(axis)

    async def clear(self, faults):
        await write(self.dut, CLEAR, faults)
        await ClockCycles(self.dut.clk, 2, FallingEdge)

    async def quiet(self, clocks):
        for _ in range(clocks):
            await FallingEdge(self.dut.clk)
            assert self.dut.inhibit.value == 0

    async def held_off(self, axes, limit):
        """Clocks until these axes and no others are held off; at most ``limit``."""
        for clocks in range(limit + 1):
            if self.dut.inhibit.value != 0:
                assert self.dut.inhibit.value == axes
                return clocks
            await FallingEdge(self.dut.clk)
        raise AssertionError(f"not within {limit} clocks")


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def limits_have_safe_values_at_reset(dut):
    bench = Bench(dut)
    await bench.start()
    for offset, value in RESET.items():
        for axis in range(AXES if offset >= STRONG_TIME else 1):
            assert await read(dut, offset + 4 * axis) == value, hex(offset)
    assert await read(dut, FAULTS) == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def the_stop_holds_all_off_while_it_lasts(dut):
    bench = Bench(dut)
    await bench.start()
    for _ in range(4):
        dut.estop.value = 1
        await FallingEdge(dut.clk)
        assert dut.inhibit.value == 0                       # sampled once
        await ClockCycles(dut.clk, 1 + LATE, FallingEdge)
        assert dut.inhibit.value == 0xf                     # twice
        await FallingEdge(dut.clk)
        assert await read(dut, FAULTS) == ESTOP == await read(dut, CAUSES)
        await bench.clear(ESTOP)
        assert await read(dut, FAULTS) == ESTOP             # it still is
        dut.estop.value = 0
        await ClockCycles(dut.clk, 2 + LATE, FallingEdge)
        assert dut.inhibit.value == 0                       # a level; but kept to be read
        assert await read(dut, FAULTS) == ESTOP and await read(dut, CAUSES) == 0
        await bench.clear(ESTOP)
        assert await read(dut, FAULTS) == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def the_watchdog_holds_all_off_until_it_is_cleared(dut):
    bench = Bench(dut)
    await bench.start()
    dut.expired.value = 1
    await FallingEdge(dut.clk)
    dut.expired.value = 0
    assert dut.inhibit.value == 0xf                         # 1 clock
    await bench.clear(0xffff | ESTOP)
    assert await read(dut, FAULTS) == WATCHDOG and dut.inhibit.value == 0xf
    await bench.clear(WATCHDOG)
    await bench.quiet(3)


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(drive=[1250, -1250, 2500], how=["nothing", "a neighbour", "far out"])
async def strong_drive_without_way_is_off_in_time(dut, drive, how):
    bench = Bench(dut)
    await bench.start()
    for axis in bench.rng.sample(range(AXES), 2):
        bench.drive(axis, drive)
        if how == "a neighbour":
            await bench.step(axis, 1)
        # Counts of one channel: to and fro between two neighbours, at any speed.
        clocks = 0
        while dut.inhibit.value == 0 and clocks < 60000:
            if how != "nothing":
                here = bench.rng.choice([1, 7, 60])
                await bench.step(axis, 1)
                await ClockCycles(dut.clk, here, FallingEdge)
                await bench.step(axis, -1)
                await FallingEdge(dut.clk)
                clocks += here + 1
            else:
                await FallingEdge(dut.clk)
                clocks += 1
        assert dut.inhibit.value == 1 << axis
        time = 1921 * SAMPLE_CLOCKS
        assert time - 200 < clocks < time + 2 * SAMPLE_CLOCKS + 100, clocks
        assert await read(dut, FAULTS) == 1 << (NO_PROGRESS + axis)
        bench.drive(axis, 0)
        await ClockCycles(dut.clk, 2 * SAMPLE_CLOCKS + SAMPLE_AGE, FallingEdge)
        await bench.clear(1 << (NO_PROGRESS + axis))
        await bench.quiet(10)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def way_in_either_direction_is_progress(dut):
    bench = Bench(dut)
    await bench.start()
    await write(dut, STRONG_TIME, 40)
    await write(dut, DRIVE_TIME, 400)
    for direction in (1, -1):
        for drive in (2500, -2500, 400, -400):
            bench.drive(0, drive)
            time = 40 if abs(drive) > 1250 else 400
            for _ in range(6):
                await bench.step(0, direction)
                await bench.quiet((time - 5) * SAMPLE_CLOCKS // 2)
                await bench.step(0, direction)
                await bench.quiet((time - 5) * SAMPLE_CLOCKS // 2)
            bench.drive(0, 0)
            await bench.quiet(3 * SAMPLE_CLOCKS)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def weak_drive_has_more_time_and_less_than_breakaway_all_of_it(dut):
    bench = Bench(dut)
    await bench.start()
    await write(dut, DRIVE_TIME, 200)
    await write(dut, BREAKAWAY + 8, 100)
    for axis, drive, moves in ((1, 379, False), (1, -380, True), (2, 99, False), (2, 100, True)):
        bench.drive(axis, drive)
        if moves:
            clocks = await bench.held_off(1 << axis, 210 * SAMPLE_CLOCKS)
            assert clocks > 200 * SAMPLE_CLOCKS
        else:
            await bench.quiet(400 * SAMPLE_CLOCKS)
        bench.drive(axis, 0)
        await ClockCycles(dut.clk, 2 * SAMPLE_CLOCKS + SAMPLE_AGE, FallingEdge)
        await bench.clear(0xffff)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def an_axis_that_holds_may_stand_at_any_drive(dut):
    bench = Bench(dut)
    await bench.start()
    await write(dut, DRIVE_TIME, 200)
    await write(dut, STRONG_TIME + 12, 100)
    await write(dut, CONTROL, 1 << (4 + 3))
    await write(dut, HELD_MOST, 1000)
    bench.drive(3, 2000)
    window = WINDOW_SAMPLES * SAMPLE_CLOCKS
    await bench.quiet(100 * SAMPLE_CLOCKS)                  # a pulse of its drive is next to nothing of its mean
    bench.drive(3, 0)
    await bench.step(3, 2)
    for _ in range(5 * MEAN_WINDOWS):
        bench.drive(3, 2000)                                # that which it takes while it moves is its mean at last
        await bench.step(3, 2)
        await bench.quiet(window - 2)
    await bench.quiet(SAMPLE_CLOCKS + SAMPLE_AGE)
    for drive in (2000, 1010, 2500):
        bench.drive(3, drive)
        await bench.quiet(300 * SAMPLE_CLOCKS)
    bench.drive(3, 950)
    assert await bench.held_off(1 << 3, 210 * SAMPLE_CLOCKS) > 200 * SAMPLE_CLOCKS
    bench.drive(3, 0)
    await ClockCycles(dut.clk, 2 * SAMPLE_CLOCKS, FallingEdge)
    await bench.clear(0xffff)
    assert await read(dut, FAULTS) == 1 << (NO_PROGRESS + 3)        # still 2000 away from it
    await write(dut, CONTROL, 0)
    await ClockCycles(dut.clk, 2 * SAMPLE_CLOCKS, FallingEdge)
    await bench.clear(0xffff)
    await bench.quiet(10)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def over_speed_is_off_at_the_end_of_its_window(dut):
    bench = Bench(dut)
    await bench.start()
    window = WINDOW_SAMPLES * SAMPLE_CLOCKS
    for direction in (1, -1):
        await bench.step(1, 35 * direction)
        await bench.quiet(2 * window)
        await bench.step(1, 70 * direction)                 # as much as may be, in at most two windows
        await bench.quiet(2 * window)
        for _ in range(4):
            await bench.step(1, 71 * direction)
            await FallingEdge(dut.clk)
            if dut.inhibit.value:
                break
            await ClockCycles(dut.clk, window // 2, FallingEdge)
        assert await bench.held_off(2, window + SAMPLE_CLOCKS + SAMPLE_AGE) is not None
        assert await read(dut, FAULTS) == 1 << (OVER_SPEED + 1)
        await ClockCycles(dut.clk, 2 * window, FallingEdge)
        await bench.clear(1 << (OVER_SPEED + 1))
        await bench.quiet(10)
    await write(dut, SPEED_MOST + 4, 20000)
    await bench.step(1, 19000)                              # a step in every clock of ``fast``: none is lost
    await bench.quiet(2 * window)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def an_armed_axis_stays_near_what_is_expected(dut):
    bench = Bench(dut)
    await bench.start()
    await write(dut, SPEED_MOST + 8, 0xffff)
    await write(dut, FOLLOWING_MOST + 8, 300)
    await bench.step(2, 500)
    await bench.quiet(3 * SAMPLE_CLOCKS)                    # not armed
    await write(dut, EXPECTED + 8, 800)
    await write(dut, CONTROL, 1 << 2)
    await bench.quiet(3 * SAMPLE_CLOCKS)
    await bench.step(2, 600)
    await bench.quiet(3 * SAMPLE_CLOCKS)
    await bench.step(2, 1)
    assert await bench.held_off(4, SAMPLE_CLOCKS + SAMPLE_AGE + 3) is not None
    assert await read(dut, FAULTS) == 1 << (FOLLOWING + 2)
    await bench.clear(0xffff)
    assert await read(dut, FAULTS) == 1 << (FOLLOWING + 2)  # the cause is not gone
    await write(dut, EXPECTED + 8, bench.counts[2] + 300)
    await ClockCycles(dut.clk, 4, FallingEdge)
    await bench.clear(0xffff)
    await bench.quiet(SAMPLE_CLOCKS)
    await write(dut, EXPECTED + 8, bench.counts[2] + 301)
    assert await bench.held_off(4, 5) is not None
    await write(dut, CONTROL, 0)
    await FallingEdge(dut.clk)
    await bench.clear(0xffff)
    await bench.quiet(SAMPLE_CLOCKS)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def illegal_transitions_have_a_budget(dut):
    bench = Bench(dut)
    await bench.start()
    window = WINDOW_SAMPLES * SAMPLE_CLOCKS
    await write(dut, ILLEGAL_TIME, 3)

    async def event(axis):
        dut.illegal.value = 1 << axis
        await FallingEdge(dut.clk)
        dut.illegal.value = 0

    for axis in range(AXES):
        await event(axis)
        assert await bench.held_off(1 << axis, 1) == 1      # none is allowed at reset
        await bench.clear(0xffff)
        assert await read(dut, CAUSES) == 1 << axis == await read(dut, FAULTS)
        await ClockCycles(dut.clk, 3 * window, FallingEdge)
        await bench.clear(0xffff)
        await bench.quiet(2)
    await write(dut, ILLEGAL_MOST, 2)
    for _ in range(12):
        await event(0)                                      # two in three windows, wherever they begin
        await bench.quiet(3 * window // 2 + 100)
    for _ in range(2):
        for _ in range(3):
            await event(0)
            await ClockCycles(dut.clk, 5, FallingEdge)
        if dut.inhibit.value:
            break
    assert dut.inhibit.value == 1


@pytest.mark.parametrize("late", [False, True])
def test_interlock(simulate, late):
    simulate(InterlockPeripheral(), random_delay=late, env={"LATE": str(int(late))})
