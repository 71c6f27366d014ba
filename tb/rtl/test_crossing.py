# SPDX-License-Identifier: BSD-2-Clause
"""rtl/crossing.py: nothing lost, nothing invented, and the latencies of the docstrings, at any clock ratio.

That no interleaving of the clocks breaks them is proven in tb/formal/crossing.py; here the numbers are
measured, with real clocks that drift past each other.  Inputs change at falling edges, so that every edge has
one answer.
"""

import os
import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
from cocotb.utils import get_sim_time

from rtl.crossing import Handover, Latch, StrobeCrossing

LATE = int(os.environ.get("LATE", "0"))         # 1: synchronisers may take one clock more

# Periods of ``sync`` and ``fast`` in ps: in phase as in the product, drifting, swapped, equal, far apart.
PERIODS = [(20000, 5000), (20002, 4996), (5000, 20000), (4998, 20014), (7002, 13006), (10000, 10000),
           (3002, 61234)]


class Watch:
    """Times of the rising edges of a clock, and what some signals showed half a clock after each."""

    def __init__(self, clock, **signals):
        self.times, self.seen = [], []
        cocotb.start_soon(self._watch(clock, signals))

    async def _watch(self, clock, signals):
        while True:
            await RisingEdge(clock)
            time = round(get_sim_time("ps"))
            await FallingEdge(clock)
            self.times.append(time)
            self.seen.append({name: int(signal.value) for name, signal in signals.items()})

    def edges(self, after, upto):
        """Number of edges after a time, up to and with another."""
        return sum(after < t <= upto for t in self.times)

    def of(self, name, level=1):
        """Times of the edges after which a signal showed a level."""
        return [t for t, seen in zip(self.times, self.seen) if seen[name] == level]

    def next(self, time):
        """The first edge after a time."""
        return next(t for t in self.times if t > time)


async def start(dut, periods, phase=0):
    """Start both clocks from reset, ``fast`` later by ``phase`` ps; returns at a falling edge of ``clk``."""
    for pin in "i", "request", "payload":
        if hasattr(dut, pin):
            getattr(dut, pin).value = 0
    dut.rst.value = dut.fast_rst.value = 1
    cocotb.start_soon(Clock(dut.clk, periods[0], unit="ps").start())
    if phase:
        await Timer(phase, unit="ps")
    cocotb.start_soon(Clock(dut.fast_clk, periods[1], unit="ps").start())
    await Timer(6 * max(periods), unit="ps")
    await FallingEdge(dut.clk)
    dut.rst.value = dut.fast_rst.value = 0
    await settle(dut, periods)


async def settle(dut, periods):
    """Long enough for everything under way to arrive."""
    await Timer(24 * max(periods), unit="ps")
    await FallingEdge(dut.clk)


async def strobe(dut, pin):
    """A strobe of one ``clk``, from falling edge to falling edge; returns the time of the edge that takes it."""
    pin.value = 1
    await RisingEdge(dut.clk)
    taken = round(get_sim_time("ps"))
    await FallingEdge(dut.clk)
    pin.value = 0
    return taken


async def until(dut, signal, level):
    while int(signal.value) != level:
        await FallingEdge(dut.clk)


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(periods=PERIODS, phase=[0, 1231])
async def a_strobe_arrives_once_and_in_time(dut, periods, phase):
    await start(dut, periods, phase)
    rng = random.Random(5)
    there, back, taken = Watch(dut.fast_clk, o=dut.o), Watch(dut.clk, ready=dut.ready), []
    for _ in range(40):
        await until(dut, dut.ready, 1)
        await ClockCycles(dut.clk, rng.randrange(1, 4), FallingEdge)
        taken.append(await strobe(dut, dut.i))
        assert not dut.ready.value
    await settle(dut, periods)
    arrived, free = there.of("o"), back.of("ready")
    for t, a in zip(taken, arrived, strict=True):
        assert there.edges(t, a) in (3, 3 + LATE)
        acted = there.next(a)
        ready = next(r for r in free if r > t)
        assert back.edges(acted, ready) in (2, 2 + LATE)
        assert ready - t <= (4 + LATE) * periods[1] + (2 + LATE) * periods[0]


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(periods=PERIODS, gap=[1, 3, 12])
async def strobes_at_any_rate_are_followed_by_an_arrival(dut, periods, gap):
    await start(dut, periods)
    rng = random.Random(gap)
    there, taken, own = Watch(dut.fast_clk, o=dut.o), [], 0
    for _ in range(80):
        for _ in range(rng.randrange(gap)):
            await FallingEdge(dut.clk)
        own += int(dut.ready.value)
        taken.append(await strobe(dut, dut.i))
    await settle(dut, periods)
    arrived = there.of("o")
    # Each one given while ready is its own; none is invented; every one has an arrival after it, in time.
    assert own <= len(arrived) <= len(taken) and dut.ready.value
    longest = 2 * ((4 + LATE) * periods[1] + (2 + LATE) * periods[0])
    for t in taken:
        assert any(t < a <= t + longest for a in arrived)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(strobes=[1, 2, 3, 4])
async def strobes_while_busy_merge_into_one(dut, strobes):
    periods = 20000, 20000
    await start(dut, periods)
    there = Watch(dut.fast_clk, o=dut.o)
    for _ in range(strobes):
        await strobe(dut, dut.i)
    await settle(dut, periods)
    assert len(there.of("o")) == min(strobes, 2)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def strobes_pass_every_fourth_clock_in_the_product(dut):
    await start(dut, (20000, 5000))
    there = Watch(dut.fast_clk, o=dut.o)
    for _ in range(50):
        assert dut.ready.value or LATE
        await strobe(dut, dut.i)
        await ClockCycles(dut.clk, 3 + 2 * LATE, FallingEdge)
    await settle(dut, (20000, 5000))
    assert len(there.of("o")) == 50


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(periods=PERIODS)
async def handover_brings_the_payload_whole_and_in_time(dut, periods):
    await start(dut, periods)
    rng = random.Random(9)
    there, given = Watch(dut.fast_clk, o_stb=dut.o_stb, o=dut.o), []
    for _ in range(40):
        await until(dut, dut.ready, 1)
        dut.payload.value = value = rng.getrandbits(32)
        given.append((await strobe(dut, dut.request), value))
        dut.payload.value = rng.getrandbits(32)         # the copy was made; this one is not asked for
    await settle(dut, periods)
    arrived = [(t, seen["o"]) for t, seen in zip(there.times, there.seen) if seen["o_stb"]]
    for (t, value), (a, got) in zip(given, arrived, strict=True):
        assert got == value and there.edges(t, a) in (4, 4 + LATE)
    for before, seen in zip(there.seen, there.seen[1:]):
        assert seen["o_stb"] or seen["o"] == before["o"]


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(periods=PERIODS)
async def handover_of_the_last_payload_never_fails(dut, periods):
    await start(dut, periods)
    rng = random.Random(10)
    there, offered, own = Watch(dut.fast_clk, o_stb=dut.o_stb, o=dut.o), {0}, set()
    for _ in range(30):
        for _ in range(rng.randrange(1, 6)):
            dut.payload.value = last = rng.getrandbits(32)
            offered.add(last)
            if dut.ready.value:
                own.add(last)
            await strobe(dut, dut.request)
            await ClockCycles(dut.clk, rng.randrange(1, 4), FallingEdge)
        await until(dut, dut.ready, 1)
        assert dut.o.value.to_unsigned() == last
    # Nothing else was ever seen, and what was given while ready was not overtaken on its way.
    assert own <= {seen["o"] for seen in there.seen} <= offered


async def count_up(dut):
    """Drive ``i`` with the number of ``fast`` clocks; it changes at falling edges."""
    value = 0
    while True:
        await FallingEdge(dut.fast_clk)
        value += 1
        dut.i.value = value


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(periods=PERIODS)
async def latch_takes_one_instant_after_the_request(dut, periods):
    await start(dut, periods)
    rng = random.Random(11)
    cocotb.start_soon(count_up(dut))
    there = Watch(dut.fast_clk, i=dut.i, capture=dut.capture)
    back = Watch(dut.clk, done=dut.done)
    results = []
    for _ in range(40):
        await ClockCycles(dut.clk, rng.randrange(1, 5), FallingEdge)
        taken = await strobe(dut, dut.request)
        await until(dut, dut.busy, 0)
        assert dut.done.value
        results.append((taken, round(get_sim_time("ps")), dut.o.value.to_unsigned()))
    await settle(dut, periods)
    assert len(back.of("done")) == 40
    for taken, read, value in results:
        # ``i`` is still from one falling edge to the next, across the edge that latches it.
        latched = there.next(next(t for t in there.of("capture") if t > taken))
        assert there.of("i", value) == [latched] and there.edges(taken, latched) in (4, 4 + LATE)
        done = next(t for t in back.of("done") if t > taken)
        assert back.edges(latched, done) in (2, 2 + LATE)


@cocotb.test(timeout_time=100, timeout_unit="ms")
@cocotb.parametrize(periods=PERIODS)
async def latch_is_done_once_for_requests_while_busy(dut, periods):
    await start(dut, periods)
    cocotb.start_soon(count_up(dut))
    there, back = Watch(dut.fast_clk, i=dut.i, capture=dut.capture), Watch(dut.clk, done=dut.done)
    for strobes in 2, 3, 5, 20:
        before = len(back.of("done"))
        for _ in range(strobes):
            taken = await strobe(dut, dut.request)
        await until(dut, dut.busy, 0)
        value = dut.o.value.to_unsigned()
        await settle(dut, periods)
        # Latched after the last request, and still since; done came with it and not in between.
        latched, = there.of("i", value)
        assert latched > taken and dut.o.value.to_unsigned() == value
        dones = back.of("done")[before:]
        assert dones[-1] > latched and (len(dones) == 1 or strobes == 20)


SUITES = {
    "strobe": lambda: StrobeCrossing(source="sync", destination="fast"),
    "handover": lambda: Handover(32, source="sync", destination="fast"),
    "latch": lambda: Latch(32, source="fast", reader="sync"),
}


@pytest.mark.parametrize("late", [False, True], ids=["", "late"])
@pytest.mark.parametrize("kind", SUITES)
def test_crossing(simulate, kind, late):
    simulate(SUITES[kind](), tests=rf"[.](a_)?{kind}", random_delay=late, env={"LATE": str(int(late))})


@pytest.mark.parametrize("make", [StrobeCrossing, lambda **d: Handover(1, **d),
                                  lambda source, destination: Latch(1, source=source, reader=destination)])
def test_two_different_domains_are_needed(make):
    with pytest.raises(ValueError, match="'fast' twice"):
        make(source="fast", destination="fast")
    with pytest.raises(ValueError, match="not 3"):
        make(source="fast", destination=3)
