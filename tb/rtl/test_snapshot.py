# SPDX-License-Identifier: BSD-2-Clause
"""rtl/snapshot.py: all axes and the time are of one clock, latched and readable when the docstrings say."""

import os
import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
from cocotb.utils import get_sim_time

from tb.rtl.register_bus import idle, read, write
from rtl.snapshot import LATCH_LATENCY, SnapshotPeripheral, Timestamp

LATE = int(os.environ.get("LATE", "0"))         # 1: synchronisers may take one clock more
START = int(os.environ.get("START", "0"))       # time at reset

CONTROL, STATUS, TICK_TIME, TICK_POSITION, SAMPLE_TIME, SAMPLE_POSITION = 0x00, 0x04, 0x08, 0x10, 0x20, 0x30

SPEEDS = [1, -1, 70000, -40000]
"""Counts per ``fast`` clock of each axis: no two clocks have a position in common."""


class Bench:
    """Both clocks, positions that depend on the clock alone, and records of the edges."""

    def __init__(self, dut, periods):
        self.dut, self.periods = dut, periods
        self.fast_edges, self.sync_edges, self.samples, self.dones = [], [], [], []
        self.ports = [getattr(dut, f"positions__{n}") for n in range(4) if hasattr(dut, f"positions__{n}")]

    async def start(self, phase=0):
        dut = self.dut
        idle(dut)
        dut.tick.value = 0
        dut.rst.value = dut.fast_rst.value = 1
        cocotb.start_soon(Clock(dut.clk, self.periods[0], unit="ps").start())
        if phase:
            await Timer(phase, unit="ps")
        cocotb.start_soon(Clock(dut.fast_clk, self.periods[1], unit="ps").start())
        await Timer(6 * max(self.periods), unit="ps")
        await FallingEdge(dut.clk)
        dut.rst.value = 0
        await FallingEdge(dut.fast_clk)
        dut.fast_rst.value = 0
        cocotb.start_soon(self._fast())
        cocotb.start_soon(self._sync())
        await ClockCycles(dut.clk, 4, FallingEdge)

    def positions(self, time):
        """What the ports show in the clock with that time."""
        return [(time - START) * speed for speed in SPEEDS[:len(self.ports)]]

    async def _fast(self):
        time = START
        while True:
            for port, value in zip(self.ports, self.positions(time)):
                port.value = value
            await RisingEdge(self.dut.fast_clk)
            self.fast_edges.append((round(get_sim_time("ps")), time))
            time += 1
            await FallingEdge(self.dut.fast_clk)
            if self.dut.sample.value:
                self.samples.append(time)
            assert self.dut.time.value.to_unsigned() == time % (1 << 64)

    async def _sync(self):
        while True:
            await RisingEdge(self.dut.clk)
            edge = round(get_sim_time("ps"))
            await FallingEdge(self.dut.clk)
            self.sync_edges.append(edge)
            if self.dut.tick_done.value:
                self.dones.append(edge)

    async def bank(self, time, position):
        """The time and the positions of a bank, read over the bus."""
        words = [await read(self.dut, time), await read(self.dut, time + 4)]
        return words[0] | words[1] << 32, [await read(self.dut, position + 4 * n, signed=True) for n in range(4)]

    def edge_of(self, time):
        """When the edge was that ended the ``fast`` clock with that time."""
        return next(edge for edge, t in self.fast_edges if t == time)

    def count(self, edges, after, upto):
        return sum(after < edge <= upto for edge in edges)


PERIODS = [(20000, 5000), (20002, 4998), (5000, 20000), (7002, 13006)]


async def tick(dut):
    """A tick of one clock; returns the time of the edge that takes it."""
    dut.tick.value = 1
    await RisingEdge(dut.clk)
    taken = round(get_sim_time("ps"))
    await FallingEdge(dut.clk)
    dut.tick.value = 0
    return taken


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(periods=PERIODS, phase=[0, 1777])
async def tick_latches_all_axes_on_one_clock_in_time(dut, periods, phase):
    bench = Bench(dut, periods)
    await bench.start(phase)
    fast = [edge for edge, _ in bench.fast_edges]
    for n in range(25):
        taken = await tick(dut)
        while len(bench.dones) == n:
            await FallingEdge(dut.clk)
        time, positions = await bench.bank(TICK_TIME, TICK_POSITION)
        assert positions[:len(bench.ports)] == bench.positions(time)
        assert not any(positions[len(bench.ports):])
        latched = bench.edge_of(time)
        fast = [edge for edge, _ in bench.fast_edges]
        assert bench.count(fast, taken, latched) in (LATCH_LATENCY, LATCH_LATENCY + LATE) and LATCH_LATENCY == 4
        assert bench.count(bench.sync_edges, latched, bench.dones[-1]) in (2, 2 + LATE)
        await ClockCycles(dut.clk, n % 4 + 1, FallingEdge)
    assert len(bench.dones) == 25


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize((("phase", "clocks"), [(0, 3), (1, 2), (2500, 2), (4999, 2)]))
async def tick_is_readable_after_2_or_3_clocks_in_the_product(dut, phase, clocks):
    bench = Bench(dut, (20000, 5000))
    await bench.start(phase)
    for n in range(10):
        taken = await tick(dut)
        await ClockCycles(dut.clk, 12, FallingEdge)
        assert bench.count(bench.sync_edges, taken, bench.dones[-1]) in range(clocks, clocks + 1 + 2 * LATE)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(periods=PERIODS)
async def sample_is_busy_from_the_write_until_it_is_readable(dut, periods):
    bench = Bench(dut, periods)
    await bench.start()
    for n in range(1, 15):
        requested = bench.fast_edges[-1][1]
        await write(dut, CONTROL, 1)
        looks = 1
        while await read(dut, STATUS):              # the first read is the clock right behind the write
            looks += 1
        assert looks > 1
        time, positions = await bench.bank(SAMPLE_TIME, SAMPLE_POSITION)
        assert time > requested and positions[:len(bench.ports)] == bench.positions(time)
        # What others latch by ``sample`` is of the same clock.
        assert bench.samples[-1] == time and len(bench.samples) == n
        for _ in range(n % 5):
            assert await read(dut, STATUS) == 0
    assert not bench.dones


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def writing_0_samples_nothing(dut):
    bench = Bench(dut, (20000, 5000))
    await bench.start()
    await write(dut, CONTROL, 0)
    for _ in range(10):
        assert await read(dut, STATUS) == 0
    assert not bench.samples and await bench.bank(SAMPLE_TIME, SAMPLE_POSITION) == (0, [0, 0, 0, 0])


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def the_banks_do_not_disturb_each_other(dut):
    bench = Bench(dut, (20000, 5000))
    await bench.start()
    rng = random.Random(4)
    banks = {"tick": (0, [0] * 4), "sample": (0, [0] * 4)}
    where = {"tick": (TICK_TIME, TICK_POSITION), "sample": (SAMPLE_TIME, SAMPLE_POSITION)}
    first = True
    for _ in range(20):
        which = rng.choice(list(banks))
        await (tick(dut) if which == "tick" else write(dut, CONTROL, 1))
        await ClockCycles(dut.clk, 10, FallingEdge)
        other = "sample" if which == "tick" else "tick"
        if not first:
            assert await bench.bank(*where[other]) == banks[other]
        before, banks[which] = banks[which], await bench.bank(*where[which])
        banks[other] = await bench.bank(*where[other])
        assert banks[which][0] > before[0]
        first = False


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def both_banks_may_be_asked_on_one_clock(dut):
    bench = Bench(dut, (20000, 5000))
    await bench.start()
    await write(dut, CONTROL, 1)            # the register answers one clock later: with the tick
    await tick(dut)
    await ClockCycles(dut.clk, 10, FallingEdge)
    a, b = await bench.bank(TICK_TIME, TICK_POSITION), await bench.bank(SAMPLE_TIME, SAMPLE_POSITION)
    assert abs(a[0] - b[0]) <= LATE
    assert a[1] == bench.positions(a[0]) and b[1] == bench.positions(b[0])


def test_snapshot(simulate):
    simulate(SnapshotPeripheral())


def test_snapshot_with_late_synchronisers(simulate):
    simulate(SnapshotPeripheral(), random_delay=True, env={"LATE": "1"})


def test_snapshot_of_two_axes_as_the_low_word_wraps(simulate):
    start = (5 << 32) - 40
    simulate(SnapshotPeripheral(axes=2, time_init=start), tests="tick_latches|sample_is",
             env={"START": str(start)})


def test_arguments_are_checked():
    with pytest.raises(ValueError, match="1 to 4 axes, not 5"):
        SnapshotPeripheral(axes=5)
    with pytest.raises(ValueError, match="64 bits"):
        Timestamp(init=-1)
