# SPDX-License-Identifier: BSD-2-Clause
"""rtl/watchdog.py: the processor is reset when it is late or asks for it, to the clock, and never otherwise."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.watchdog import (DRIVES_OFF_CLOCKS, KICK_WORD, RESET_CLOCKS, RESET_WORD, TIMEOUT_CLOCKS, Cause,
                          WatchdogPeripheral)
from tb.rtl.register_bus import idle, read, write

CONTROL, TIMEOUT, KICK, STATUS, RESET, SCRATCH = range(0, 0x18, 4)
RUNNING, COLD = 4, 8
WRITE_CLOCKS = 1            # from the bus strobe to the register's


async def start(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value = 1
    await FallingEdge(dut.clk)
    dut.rst.value = 0
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    return random.Random(seed)


async def clocks_until(dut, pin, limit):
    """Clocks from now until the pin is high at a falling edge; None if that is more than ``limit``."""
    for clocks in range(limit + 1):
        if pin.value:
            return clocks
        await FallingEdge(dut.clk)
    return None


async def reset_sequence(dut):
    """Asserts the whole sequence, whose first clock this is."""
    for clock in range(DRIVES_OFF_CLOCKS + RESET_CLOCKS + 40):
        assert dut.expired.value == (clock == 0), clock
        assert dut.cpu_reset.value == (DRIVES_OFF_CLOCKS <= clock < DRIVES_OFF_CLOCKS + RESET_CLOCKS), clock
        await FallingEdge(dut.clk)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_late_kick_resets_the_processor_to_the_clock(dut):
    rng = await start(dut)
    assert await read(dut, TIMEOUT) == TIMEOUT_CLOCKS
    for timeout in (0, 1, 7, 30, 500):
        await write(dut, TIMEOUT, timeout)
        await write(dut, CONTROL, 1)
        for _ in range(8 if timeout > 4 else 0):
            # A kick a clock before it would be too late; a word that is none changes nothing.
            await ClockCycles(dut.clk, rng.choice([1, timeout - 2]), FallingEdge)
            await write(dut, KICK, KICK_WORD)
        if timeout > 4:
            await write(dut, KICK, KICK_WORD ^ 1 << rng.randrange(32))
        sooner = timeout > 4
        assert await clocks_until(dut, dut.expired, timeout + 9) == timeout + 2 + WRITE_CLOCKS - 1 - sooner
        await reset_sequence(dut)
        assert await read(dut, STATUS) == Cause.WATCHDOG.value | COLD


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_kick_a_clock_too_late_is_none(dut):
    await start(dut)
    for clocks, late in (48, False), (49, False), (50, True), (51, True):
        await write(dut, TIMEOUT, 50)
        await write(dut, CONTROL, 1)
        await ClockCycles(dut.clk, clocks, FallingEdge)
        await write(dut, KICK, KICK_WORD)
        assert (await clocks_until(dut, dut.expired, 10) is not None) == late, clocks
        if not late:
            assert await clocks_until(dut, dut.expired, 60) is not None
        await ClockCycles(dut.clk, DRIVES_OFF_CLOCKS + RESET_CLOCKS, FallingEdge)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def kicked_in_time_it_never_acts_and_stopped_it_waits(dut):
    rng = await start(dut)
    await write(dut, TIMEOUT, 20)
    assert await clocks_until(dut, dut.expired, 100) is None
    await write(dut, CONTROL, 0)
    assert await clocks_until(dut, dut.expired, 100) is None
    assert await read(dut, STATUS) == COLD
    await write(dut, CONTROL, 1)
    for _ in range(200):
        for _ in range(rng.randrange(18)):
            await FallingEdge(dut.clk)
            assert not dut.expired.value and not dut.cpu_reset.value
        await write(dut, rng.choice([CONTROL, KICK]), KICK_WORD)            # bit 0 is set: enable, again
        await write(dut, KICK, KICK_WORD)
    assert await read(dut, STATUS) == RUNNING | COLD
    await write(dut, CONTROL, 0)
    assert await clocks_until(dut, dut.expired, 40) is not None             # nothing stops it


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def the_processor_may_ask_for_its_reset(dut):
    rng = await start(dut)
    for _ in range(20):
        await write(dut, RESET, RESET_WORD ^ 1 << rng.randrange(32))
        assert await clocks_until(dut, dut.expired, 20) is None
        await write(dut, RESET, RESET_WORD)
        assert await clocks_until(dut, dut.expired, 5) == WRITE_CLOCKS
        await reset_sequence(dut)
        assert await read(dut, STATUS) == Cause.COMMAND.value | COLD


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def registers_survive_and_the_watchdog_stops(dut):
    await start(dut)
    await write(dut, SCRATCH, 0x12345678)
    await write(dut, STATUS, COLD)
    await write(dut, TIMEOUT, 30)
    await write(dut, CONTROL, 1)
    assert await clocks_until(dut, dut.cpu_reset, 60) is not None
    await write(dut, CONTROL, 1)                                            # while it is being reset: too early
    await ClockCycles(dut.clk, 100, FallingEdge)
    assert await read(dut, STATUS) == Cause.WATCHDOG.value
    assert await read(dut, SCRATCH) == 0x12345678 and await read(dut, TIMEOUT) == 30
    await write(dut, CONTROL, 1)
    assert await clocks_until(dut, dut.expired, 60) is not None


def test_watchdog(simulate):
    simulate(WatchdogPeripheral())
