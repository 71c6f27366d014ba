# SPDX-License-Identifier: BSD-2-Clause
"""rtl/trigger.py: the registers of the trigger, over the bus, and its pins."""

import random
from collections import deque

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, Timer

from rtl.trigger import MINIMUM, TriggerPeripheral
from tb.rtl.register_bus import idle, read, write

AXES, DEPTH = 4, 6
CONFIG, INTERRUPT, LEVEL, MISSED, NEXT, TIME, COUNT = 0x00, 0x04, 0x08, 0x0c, 0x10, 0x14, 0x1c
ENABLE, OUTPUT, FALLING, MINIMUM_SHIFT = 1, 2, 4, 3


def config(*flags, minimum=MINIMUM):
    return sum(flags) | minimum << MINIMUM_SHIFT


class Trigger:
    """The block under test; its positions and time stand still while a pulse begins, and are others at the next."""

    def __init__(self, dut):
        self.dut = dut
        seed = random.randrange(1 << 32)
        dut._log.info(f"seed {seed}")
        self.rng, self.waiting, self.missed = random.Random(seed), deque(), 0

    async def start(self, phase=0):
        dut = self.dut
        idle(dut)
        dut.in0.value = dut.out0.value = 0
        self.stand()
        dut.rst.value = dut.fast_rst.value = 1
        cocotb.start_soon(Clock(dut.clk, 20000, unit="ps").start())
        await Timer(phase + 1, unit="ps")
        cocotb.start_soon(Clock(dut.fast_clk, 5000, unit="ps").start())
        await ClockCycles(dut.clk, 8, FallingEdge)
        dut.rst.value = dut.fast_rst.value = 0
        await ClockCycles(dut.clk, 16, FallingEdge)

    def stand(self):
        self.record = [self.rng.getrandbits(64), *(self.rng.getrandbits(32) - (1 << 31) for _ in range(AXES))]
        self.dut.time.value = self.record[0]
        for n in range(AXES):
            getattr(self.dut, f"count__{n}").value = self.record[1 + n] & 0xffffffff
            getattr(self.dut, f"filter__{n}").value = self.rng.randrange(16)

    async def level(self, level, clocks, *, pin="in0"):
        """For so many clocks; the last of them is the one in which the next thing may happen."""
        await FallingEdge(self.dut.fast_clk)
        getattr(self.dut, pin).value = level
        await ClockCycles(self.dut.fast_clk, clocks - 1, FallingEdge)

    async def pulse(self, clocks=MINIMUM + 3, *, pin="in0", high=1, recorded=True):
        """Positions stand still from the pulse to the pause."""
        self.stand()
        await self.level(high, clocks, pin=pin)
        await self.level(1 - high, MINIMUM + 12, pin=pin)
        if recorded and len(self.waiting) < DEPTH:
            self.waiting.append(self.record)
        else:
            self.missed += recorded

    async def on_bus(self, operation, *arguments, **options):
        await FallingEdge(self.dut.clk)
        return await operation(self.dut, *arguments, **options)

    async def configure(self, value):
        await self.on_bus(write, CONFIG, value)
        assert await self.on_bus(read, CONFIG) == value
        await ClockCycles(self.dut.clk, 14, FallingEdge)

    async def take(self):
        """The oldest record, read and taken."""
        time = await self.on_bus(read, TIME) | await self.on_bus(read, TIME + 4) << 32
        counts = [await self.on_bus(read, COUNT + 4 * n, signed=True) for n in range(AXES)]
        await self.on_bus(write, NEXT, 1)
        return [time, *counts]

    async def check(self):
        """What waits is what was given."""
        assert await self.on_bus(read, LEVEL) == len(self.waiting)
        assert await self.on_bus(read, MISSED) == self.missed
        while self.waiting:
            assert await self.take() == self.waiting.popleft()
            assert await self.on_bus(read, LEVEL) == len(self.waiting)


async def begin(dut, phase=0):
    trigger = Trigger(dut)
    await trigger.start(phase)
    return trigger


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(phase=[0, 1234, 4000])
async def records_are_read_in_order(dut, phase):
    trigger = await begin(dut, phase)
    await trigger.pulse(recorded=False)                 # not enabled yet
    await trigger.configure(config(ENABLE))
    for _ in range(12):
        for _ in range(trigger.rng.randrange(1, DEPTH + 1)):
            await trigger.pulse(trigger.rng.randrange(MINIMUM + 2, 60))      # a synchroniser may eat one
        await trigger.check()
    await trigger.configure(config())
    await trigger.pulse(recorded=False)
    await trigger.check()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def records_without_room_are_counted(dut):
    trigger = await begin(dut)
    await trigger.configure(config(ENABLE))
    for pulses in DEPTH, DEPTH + 1, DEPTH + 5, 3 * DEPTH:
        for _ in range(pulses):
            await trigger.pulse()
        await trigger.on_bus(write, NEXT, 0)            # takes nothing
        if pulses > DEPTH + 1:                          # room for one: one more
            assert await trigger.take() == trigger.waiting.popleft()
            await trigger.pulse()
        await trigger.check()
    assert trigger.missed == 1 + 5 + 2 * DEPTH


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(pin=["in0", "out0"], falling=[0, 1])
async def either_pin_and_either_edge_trigger(dut, pin, falling):
    trigger = await begin(dut)
    other = "out0" if pin == "in0" else "in0"
    await trigger.level(falling, 40, pin=pin)
    await trigger.configure(config(ENABLE, OUTPUT * (pin == "out0"), FALLING * falling))
    for _ in range(3):
        await trigger.pulse(pin=pin, high=1 - falling)
        await trigger.pulse(pin=other, high=1 - falling, recorded=False)
    await trigger.check()


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(pin=["in0", "out0"])
async def the_latch_comes_four_clocks_after_the_sample_and_the_filter(dut, pin):
    """Whichever pin; positions and time are the number of the clock."""
    trigger = await begin(dut)
    await trigger.configure(config(ENABLE, OUTPUT * (pin == "out0")))
    filters, clock = [0, 1, 9, 15], 0
    for n, samples in enumerate(filters):
        getattr(dut, f"filter__{n}").value = samples

    async def hold(level, clocks):
        nonlocal clock
        getattr(dut, pin).value = level
        for _ in range(clocks):
            clock += 1
            dut.time.value = clock
            for n in range(AXES):
                getattr(dut, f"count__{n}").value = clock
            await FallingEdge(dut.fast_clk)

    await FallingEdge(dut.fast_clk)
    for rest in 40, 41, 42, 43:
        await hold(0, rest)
        sampled = clock + 1                     # at the end of the next clock
        trigger.waiting.append([sampled + 3, *(sampled + 4 + samples for samples in filters)])
        await hold(1, 30)
    await hold(0, 40)
    await trigger.check()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_setting_is_no_pulse(dut):
    """Another polarity or pin makes the level that is looked at jump, and nothing of it."""
    trigger = await begin(dut)
    await trigger.level(1, 40, pin="out0")
    await trigger.level(0, 40, pin="in0")
    for value in (config(ENABLE), config(ENABLE, FALLING), config(ENABLE), config(ENABLE, OUTPUT), config(ENABLE),
                  config(ENABLE, FALLING, OUTPUT), config(), config(ENABLE)):
        await trigger.configure(value)
        await trigger.level(0, 60, pin="in0")
    await trigger.check()
    await trigger.pulse()
    await trigger.check()


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(minimum=[0, 17, MINIMUM, 100, 255])
async def a_pulse_lasts_for_the_minimum(dut, minimum):
    trigger = await begin(dut)
    await trigger.configure(config(ENABLE, minimum=minimum))
    shortest = max(minimum, MINIMUM)
    for clocks in shortest - 1, shortest, shortest - 5, shortest + 1:
        await trigger.pulse(clocks, recorded=clocks >= shortest)
        await trigger.level(0, shortest)
    await trigger.check()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def the_interrupt_says_that_records_wait(dut):
    trigger = await begin(dut)
    await trigger.configure(config(ENABLE))
    await trigger.pulse()
    assert not dut.interrupt.value
    await trigger.on_bus(write, INTERRUPT, 1)
    assert await trigger.on_bus(read, INTERRUPT) == 1
    await trigger.pulse()
    assert dut.interrupt.value
    await trigger.check()
    await FallingEdge(dut.clk)
    assert not dut.interrupt.value


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def pulses_may_follow_each_other_at_twice_the_minimum(dut):
    """The shortest pulse and the shortest pause, 36 clocks, 180 ns; when the pause is over,
    the record can be read."""
    trigger = await begin(dut)
    await trigger.configure(config(ENABLE))
    for _ in range(DEPTH):
        await trigger.level(1, MINIMUM)
        await trigger.level(0, MINIMUM)
    assert await trigger.on_bus(read, LEVEL) == DEPTH
    await trigger.level(1, MINIMUM)                     # and after a pause a clock too short none
    await trigger.level(0, MINIMUM - 1)
    await trigger.level(1, MINIMUM)
    await trigger.level(0, 40)
    assert await trigger.on_bus(read, MISSED) == 1


def test_trigger_registers(simulate):
    simulate(TriggerPeripheral(axes=AXES, depth=DEPTH))


def test_trigger_registers_with_late_synchronisers(simulate):
    simulate(TriggerPeripheral(axes=AXES, depth=DEPTH), random_delay=True, tests="records_|either|a_setting|the_interrupt")


def test_arguments_are_checked():
    with pytest.raises(ValueError, match="1 to 4 axes, not 5"):
        TriggerPeripheral(axes=5)
