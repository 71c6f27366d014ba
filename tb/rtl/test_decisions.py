# SPDX-License-Identifier: BSD-2-Clause
"""rtl/decisions.py at its pin and over its bus: pulses of any length and at any phase, each read once and in order."""

import os
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer

from rtl.decisions import BATCHES, DECISION_LATENCY, ClassifierPeripheral, DecisionQueue, PulseInput
from tb.rtl.register_bus import idle, read, write

THRESHOLD, CONFIG, DECISIONS, STATUS, LOST, CONTROL = range(0, 24, 4)
ENABLE, AT_THRESHOLD = 1, 2
DEFAULT_THRESHOLD, DEFAULT_FILTER = 150_000, 19

FAST_PS, SYNC_PS = 5000, 20000
TAKEN = 7               # `sync` clocks in which a setting is at work
READABLE = 7            # `sync` edges after that which shows a decision


def decided(batch):
    """Decisions of a batch, in their order."""
    return [int(bit) for bit in bin(batch)[3:]]


async def start(dut, shift_ps=0):
    """Both clocks, edges of `sync` on every fourth of `fast`, or `shift_ps` later; reset; a generator of numbers."""
    cocotb.start_soon(Clock(dut.fast_clk, FAST_PS, unit="ps").start())
    if shift_ps:
        await Timer(shift_ps, unit="ps")
    cocotb.start_soon(Clock(dut.clk, SYNC_PS, unit="ps").start())
    idle(dut)
    dut.pin.value = 0
    dut.rst.value = dut.fast_rst.value = 1
    for _ in range(3):
        await FallingEdge(dut.clk)
    dut.rst.value = dut.fast_rst.value = 0
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    return random.Random(seed)


async def configure(dut, threshold, *, filter=0, flags=ENABLE):
    await write(dut, THRESHOLD, threshold)
    await write(dut, CONFIG, filter << 2 | flags)
    for _ in range(TAKEN):
        await FallingEdge(dut.clk)


async def take_all(dut):
    """Decisions that wait, read as quickly as the bus goes."""
    taken = []
    await FallingEdge(dut.clk)
    while (batch := await read(dut, DECISIONS)) != 1:
        taken += decided(batch)
        await FallingEdge(dut.clk)
    return taken


async def settle(dut, clocks=12):
    for _ in range(clocks):
        await FallingEdge(dut.clk)


async def pulse(dut, high_ps, low_ps):
    dut.pin.value = 1
    await Timer(high_ps, unit="ps")
    dut.pin.value = 0
    await Timer(low_ps, unit="ps")


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_decision_shows_after_the_latency_and_the_filter(dut):
    """Levels of PulseInput clock by clock: long at clock number `threshold`, short at the clock after the pulse."""
    cocotb.start_soon(Clock(dut.fast_clk, FAST_PS, unit="ps").start())
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    rng = random.Random(seed)
    for samples in 0, 1, 2, 19, 31:
        dut.settings.value = samples << 34 | 0b10 << 32 | 50
        dut.pin.value, dut.fast_rst.value = 0, 1
        await FallingEdge(dut.fast_clk)
        dut.fast_rst.value = 0
        levels, wanted = [0] * 40, []
        for _ in range(40):
            length = rng.choice([1, samples, samples + 1, 49, 50, rng.randint(1, 90)])
            if length > samples:
                at = len(levels) + (49 if length >= 50 else length)
                wanted.append((at + DECISION_LATENCY + samples, int(length >= 50)))
            levels += [1] * length + [0] * rng.randint(samples + 1, 60)
        seen = []
        for clock, level in enumerate(levels + [0] * 40):
            dut.pin.value = level
            if dut.decided.value:
                seen.append((clock, int(dut.long.value)))
            await FallingEdge(dut.fast_clk)
        assert seen == wanted and {long for _, long in wanted} == {0, 1}, samples


def test_input(simulate):
    simulate(PulseInput(), tests="a_decision_shows")


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_threshold_is_sharp_at_every_phase(dut):
    """One clock of `fast` tells long from short, at any phase of the pulse in both clocks; with and without filter."""
    rng = await start(dut)
    for threshold, filter in (1, 0), (2, 0), (33, 0), (33, DEFAULT_FILTER), (1000, DEFAULT_FILTER):
        await configure(dut, threshold, filter=filter)
        wanted = []
        for phase in range(60):
            await FallingEdge(dut.clk)
            await Timer(1 + SYNC_PS * phase // 60 + rng.randrange(SYNC_PS // 60), unit="ps")
            long = threshold <= filter + 1 or rng.randrange(2)
            wanted.append(int(long))
            await pulse(dut, (threshold - 1 + long) * FAST_PS, 12 * SYNC_PS)
        await settle(dut)
        assert await take_all(dut) == wanted and 1 in wanted, (threshold, filter)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def pulses_shorter_than_the_filter_are_not_seen(dut):
    """By default those of less than 100 ns, and breaks as short do not end a pulse."""
    await start(dut)
    assert await read(dut, THRESHOLD) == DEFAULT_THRESHOLD
    assert await read(dut, CONFIG) == DEFAULT_FILTER << 2
    await configure(dut, 100, filter=DEFAULT_FILTER)
    for width_ns, seen in (5, []), (50, []), (94, []), (101, [0]), (494, [0]), (501, [1]):
        await pulse(dut, width_ns * 1000, 2_000_000)
        assert await take_all(dut) == seen, width_ns
    for _ in range(3):                      # 600 ns with two breaks
        await pulse(dut, 200_000, 50_000)
    await settle(dut)
    assert await take_all(dut) == [1]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_level_at_the_threshold_decides_if_so_set(dut):
    await start(dut)
    await configure(dut, 40, flags=ENABLE | AT_THRESHOLD)
    await pulse(dut, 50_000, 100_000)       # 10 clocks, and 30 until the threshold has passed
    assert await take_all(dut) == []
    await settle(dut)
    await pulse(dut, 50_000, 50_000)        # a second rise before it, and high at it
    await pulse(dut, 200_000, 1000)
    await settle(dut)
    assert await take_all(dut) == [0, 1]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def what_is_disabled_or_cleared_does_not_come(dut):
    await start(dut)
    await write(dut, THRESHOLD, 100)
    await pulse(dut, 100_000, 400_000)      # not enabled
    assert await take_all(dut) == []
    await configure(dut, 100)
    dut.pin.value = 1
    await settle(dut)
    await configure(dut, 100, flags=0)      # under way
    await configure(dut, 100)
    await pulse(dut, 700_000, 400_000)      # high since before
    assert await take_all(dut) == []
    for high_ns in 100, 600, 100:
        await pulse(dut, high_ns * 1000, 400_000)
    await settle(dut)
    assert await read(dut, STATUS) == 3
    await write(dut, CONTROL, 1)
    await FallingEdge(dut.clk)
    assert await read(dut, STATUS) == 0 and await take_all(dut) == []
    await pulse(dut, 600_000, 400_000)
    assert await take_all(dut) == [1]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_decision_can_be_read_after_seven_clocks(dut):
    """At every phase of the two clocks: 4 of `fast` to an edge, and any shift of it."""
    rng = await start(dut, shift_ps=int(os.environ["SHIFT"]))
    await configure(dut, 1000)
    latest = 0
    for n in range(100):
        await RisingEdge(dut.fast_clk)
        await Timer(1 + FAST_PS * (n % 4) + rng.randrange(FAST_PS - 1), unit="ps")
        await pulse(dut, 100_000, 1)
        for _ in range(1 + DECISION_LATENCY):
            await RisingEdge(dut.fast_clk)
        edges = 0
        while True:
            await FallingEdge(dut.clk)
            edges += 1
            if await read(dut, STATUS):     # takes a clock: shows what the edge before saw
                break
            edges += 1
        latest = max(latest, edges)
        assert await take_all(dut) == [0]
    assert latest <= READABLE, latest


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_hundred_thousand_pulses_are_read_once_and_in_order(dut):
    """One in three clocks of `fast`, 66 million a second, read whenever the bus is free.

    Times are multiples of `GRAIN` clocks: what a synchroniser is late by then turns no short pulse into a long one.
    """
    rng = await start(dut, shift_ps=int(os.environ["SHIFT"]))
    count, threshold, grain = int(os.environ["PULSES"]), 3, int(os.environ["GRAIN"])
    await configure(dut, threshold * grain - (grain > 1))
    wanted, over = [], False

    async def play():
        nonlocal over
        await FallingEdge(dut.fast_clk)
        while len(wanted) < count:
            # Bursts of the shortest pulses that may go on for ever, and others.
            if rng.random() < 0.7:
                shape = rng.choice([(1, 2), (2, 1)])
            else:
                shape = rng.choice([(3, 1), (2, 3), (4, 2), (rng.randint(1, 30), rng.randint(2, 40))])
            dut.pin.value = 1
            for _ in range(shape[0] * grain):
                await FallingEdge(dut.fast_clk)
            dut.pin.value = 0
            wanted.append(int(shape[0] >= threshold))
            for _ in range(shape[1] * grain):
                await FallingEdge(dut.fast_clk)
        over = True

    cocotb.start_soon(play())
    taken = []
    while not over:
        if (batch := await read(dut, DECISIONS)) == 1:
            for _ in range(rng.choice([0, 0, 3, 100])):
                await FallingEdge(dut.clk)
        taken += decided(batch)
        await FallingEdge(dut.clk)
    await settle(dut)
    taken += await take_all(dut)
    assert len(taken) == len(wanted) >= count and taken == wanted
    assert await read(dut, LOST) == 0
    dut._log.info(f"{len(taken)} pulses, {sum(taken)} of them long")


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_reader_may_be_away_for_as_many_batches_as_fit(dut):
    """2048 decisions, each alone, wait; then one more loses those that come, which are counted."""
    rng = await start(dut)
    await configure(dut, 20)
    wanted = []
    for _ in range(BATCHES):
        wanted.append(rng.randrange(2))
        await pulse(dut, (25 if wanted[-1] else 10) * FAST_PS, 20 * FAST_PS)
    await settle(dut)
    assert await read(dut, STATUS) == BATCHES and await read(dut, LOST) == 0
    for _ in range(10):                     # while one crosses others gather: five batches of two or so
        await pulse(dut, 2 * FAST_PS, 2 * FAST_PS)
    await settle(dut)
    assert await read(dut, LOST) == 10
    assert await take_all(dut) == wanted
    assert await read(dut, STATUS) == 0


def test_peripheral(simulate):
    simulate(ClassifierPeripheral(), tests="threshold|shorter_than|disabled")


def test_reader(simulate):
    simulate(ClassifierPeripheral(), tests="may_be_away")


def test_latency(simulate):
    for shift in 0, 1300, 3700:
        simulate(ClassifierPeripheral(), tests="seven_clocks", env={"SHIFT": str(shift)})


def test_stream(simulate):
    simulate(ClassifierPeripheral(), tests="hundred_thousand", env={"SHIFT": "0", "PULSES": "100000", "GRAIN": "1"})


def test_stream_with_late_synchronisers(simulate):
    """Any phase, and every synchroniser late at random: one pulse in nine clocks."""
    simulate(ClassifierPeripheral(), random_delay=True, tests="hundred_thousand",
             env={"SHIFT": "2900", "PULSES": "20000", "GRAIN": "3"})


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def decisions_faster_than_they_cross_are_lost_and_counted(dut):
    """A decision in every clock: what is not counted as lost is there, in its place."""
    cocotb.start_soon(Clock(dut.fast_clk, FAST_PS, unit="ps").start())
    cocotb.start_soon(Clock(dut.clk, SYNC_PS, unit="ps").start())
    for pin in dut.decided, dut.long, dut.take, dut.clear:
        pin.value = 0
    dut.rst.value = dut.fast_rst.value = 1
    for _ in range(3):
        await FallingEdge(dut.clk)
    dut.rst.value = dut.fast_rst.value = 0
    await FallingEdge(dut.fast_clk)
    sent = [n & 1 for n in range(400)]
    for long in sent:
        dut.decided.value, dut.long.value = 1, long
        await FallingEdge(dut.fast_clk)
    dut.decided.value = 0
    for high in 0, 1:                       # two more, so that the last count arrives
        for _ in range(60):
            await FallingEdge(dut.fast_clk)
        dut.decided.value, dut.long.value = 1, 1
        await FallingEdge(dut.fast_clk)
        dut.decided.value = 0
    for _ in range(20):
        await FallingEdge(dut.clk)
    taken = []
    while (batch := int(dut.batch.value)) != 1:
        taken += decided(batch)
        dut.take.value = 1
        await FallingEdge(dut.clk)
        dut.take.value = 0
    lost = int(dut.lost.value)
    assert len(taken) + lost == len(sent) + 2 and 100 < lost < 300, (len(taken), lost)
    source = iter(sent + [1, 1])
    assert all(any(long == other for other in source) for long in taken)    # a subsequence


def test_queue(simulate):
    simulate(DecisionQueue(batches=512), tests="faster_than")
