# SPDX-License-Identifier: BSD-2-Clause
"""rtl/timer.py: counts every clock, latches all of itself at once, and rings when it was told to."""

import os

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.timer import TimerPeripheral
from tb.rtl import register_bus
from tb.rtl.register_bus import idle, read

COUNT, CONTROL, LOW, HIGH, ALARM, STATUS, INTERRUPT = range(0, 0x1c, 4)
LATCH, ARM, CANCEL = 1, 2, 4
MASK = 0xffffffff

START = int(os.environ.get("START", "0"))       # count at reset
CARRY = START & MASK != 0                 # the low half overflows soon


async def start(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value = 1
    await FallingEdge(dut.clk)
    dut.rst.value = 0
    await FallingEdge(dut.clk)


async def write(dut, offset, value):
    """As the bridge writes, in 2 clocks: the block acts on it in the second."""
    await register_bus.write(dut, offset, value)
    await FallingEdge(dut.clk)


async def count_at_interrupt(dut, limit):
    """The count in the first clock in which the interrupt is high; None if that is more than ``limit`` ahead."""
    count = (await read(dut, COUNT) + 1) & MASK         # read in the clock before this one
    for _ in range(limit):
        if dut.interrupt.value:
            return count
        await FallingEdge(dut.clk)
        count = (count + 1) & MASK
    return None


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def count_rises_by_one_a_clock(dut):
    await start(dut)
    first = await read(dut, COUNT)
    for clocks in (1, 10, 100):
        await ClockCycles(dut.clk, clocks, FallingEdge)
        second = await read(dut, COUNT)
        assert (second - first) & MASK == clocks + 1     # the read takes one
        first = second


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def both_halves_are_of_one_clock(dut):
    await start(dut)
    latched = []
    for _ in range(40):
        await write(dut, CONTROL, LATCH)                                    # 2 clocks
        latched.append(await read(dut, LOW) | await read(dut, HIGH) << 32)  # 1 and 1
    assert latched[0] >> 32 == START >> 32 and latched[-1] >> 32 == (START >> 32) + CARRY
    assert [b - a for a, b in zip(latched, latched[1:])] == [4] * 39
    await write(dut, CONTROL, ARM | CANCEL)
    assert await read(dut, LOW) | await read(dut, HIGH) << 32 == latched[-1]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def rings_once_at_the_alarm(dut):
    await start(dut)
    for ahead in (20, 21, 50, 200):
        alarm = (await read(dut, COUNT) + ahead) & MASK
        await write(dut, ALARM, alarm)
        await write(dut, CONTROL, ARM)
        assert await read(dut, STATUS) == 1
        # Expired 1 clock after the count is reached, the interrupt 1 clock after that.
        assert await count_at_interrupt(dut, 400) == (alarm + 2) & MASK
        assert await read(dut, STATUS) == 0
        await write(dut, INTERRUPT, 1)
        assert await count_at_interrupt(dut, 300) is None


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def an_alarm_in_the_past_rings_at_once(dut):
    await start(dut)
    for behind in (0, 1, 1000, (1 << 31) - 100):
        await write(dut, ALARM, (await read(dut, COUNT) - behind) & MASK)
        await write(dut, CONTROL, ARM)
        # Clock 1 after the strobe: armed.  2: expired.  3: interrupt.
        for expected in (0, 0, 1):
            assert dut.interrupt.value == expected
            await FallingEdge(dut.clk)
        await write(dut, INTERRUPT, 1)
        assert dut.interrupt.value == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def an_alarm_far_ahead_waits_and_can_be_cancelled(dut):
    await start(dut)
    await write(dut, ALARM, (await read(dut, COUNT) + (1 << 31) - 1) & MASK)
    await write(dut, CONTROL, ARM)
    assert await count_at_interrupt(dut, 100) is None
    assert await read(dut, STATUS) == 1
    await write(dut, CONTROL, CANCEL | ARM)
    assert await read(dut, STATUS) == 0
    # Not armed: passing the alarm means nothing.
    await write(dut, ALARM, (await read(dut, COUNT) + 10) & MASK)
    assert await count_at_interrupt(dut, 100) is None


@pytest.mark.parametrize("start_count", [0, (7 << 32) - 60])
def test_timer(simulate, start_count):
    simulate(TimerPeripheral(init=start_count), env={"START": str(start_count)})
