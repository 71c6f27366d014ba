# SPDX-License-Identifier: BSD-2-Clause
"""rtl/line.py: how soon a write reaches the line, and how old a register or an interrupt may be."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer

from rtl.line import LinePeripheral

FAST_PS, SYNC_PS = 5000, 20000
AGE_CLOCKS = 12                 # of registers and interrupts; also of a route on its way to the pin
BUSY_CLOCKS = 16
CONTROL, STATUS, INTERRUPT, PRODUCED = ("compare", 2), ("compare", 3), ("compare", 4), ("divider", 9)
BUSY, ARMED = 8, 1


async def start(dut, phase):
    for bank in "compare", "divider", "router":
        for port in "addr", "r_stb", "w_stb", "w_data":
            getattr(dut, f"{bank}_bus__{port}").value = 0
    for axis in range(4):
        for name in "moved", "up", "count", "a":
            getattr(dut, f"step{axis}__{name}").value = 0
    dut.rst.value = dut.fast_rst.value = 1
    cocotb.start_soon(Clock(dut.clk, SYNC_PS, unit="ps").start())
    await Timer(phase + 1, unit="ps")
    cocotb.start_soon(Clock(dut.fast_clk, FAST_PS, unit="ps").start())
    await Timer(200, unit="ns")
    await FallingEdge(dut.clk)
    dut.rst.value = dut.fast_rst.value = 0
    await Timer(2, unit="us")
    await FallingEdge(dut.clk)


async def write(dut, bank, word, value):
    """From falling edge to falling edge; the register holds it from the edge that follows."""
    port = lambda name: getattr(dut, f"{bank}_bus__{name}")
    port("addr").value, port("w_data").value, port("w_stb").value = word, value, 1
    await FallingEdge(dut.clk)
    port("w_stb").value = 0


async def clocks_until(dut, true, limit):
    for n in range(limit + 1):
        if true():
            return n
        await FallingEdge(dut.clk)
    raise AssertionError(f"not within {limit} clocks")


async def watch(dut, where):
    """Read a register in every clock from now on: its value of the clock before, with no delay of the bus besides."""
    bank, word = where
    getattr(dut, f"{bank}_bus__addr").value, getattr(dut, f"{bank}_bus__r_stb").value = word, 1
    await RisingEdge(dut.clk)
    await FallingEdge(dut.clk)
    return lambda: getattr(dut, f"{bank}_bus__r_data").value.to_unsigned()


async def step(dut, count):
    """One edge upward on X, in one fast clock."""
    await FallingEdge(dut.fast_clk)
    dut.step0__moved.value, dut.step0__up.value, dut.step0__count.value = 1, 1, count
    await FallingEdge(dut.fast_clk)
    dut.step0__moved.value = 0


async def set_line(dut, *, pixels=1):
    """Reference edge 1 on X, N = 1."""
    for bank, word, value in (("compare", 1, 1), ("divider", 1, 1), ("divider", 4, pixels), ("divider", 5, 1),
                              ("divider", 6, 100), ("divider", 7, 1)):
        await write(dut, bank, word, value)


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(phase=[0, 1700, 3300, 4900])
async def a_command_is_in_status_when_busy_falls_within_16_clocks(dut, phase):
    await start(dut, phase)
    await set_line(dut)
    worst = 0
    for turn in range(40):
        await ClockCycles(dut.clk, 1 + turn % 23, FallingEdge)      # at all phases of the report's round
        disarm = turn % 2
        await write(dut, *CONTROL, 2 if disarm else 1)
        await FallingEdge(dut.clk)                      # as the bridge writes, in 2 clocks
        status = await watch(dut, STATUS)
        assert status() & BUSY
        worst = max(worst, await clocks_until(dut, lambda: not status() & BUSY, BUSY_CLOCKS))
        assert status() == (0 if disarm else ARMED)
    dut._log.info("busy for at most %d clocks", worst)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def busy_shows_in_the_clock_right_behind_the_write(dut):
    await start(dut, 0)
    await set_line(dut)
    for command in (1, 2, 3, 1):
        await write(dut, *CONTROL, command)
        status = await watch(dut, STATUS)
        assert status() & BUSY
        await clocks_until(dut, lambda: not status() & BUSY, BUSY_CLOCKS)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def two_lines_that_start_between_two_reports_are_not_none(dut):
    """Armed again while the stage trembles at the reference: whether one or two lines start, the event is there."""
    await start(dut, 0)
    await set_line(dut, pixels=1000)
    seen = set()
    for offset in range(60):
        await write(dut, *CONTROL, 1)
        await Timer(800, unit="ns")
        await FallingEdge(dut.clk)
        await write(dut, *INTERRUPT, 7)
        await FallingEdge(dut.clk)
        assert dut.interrupt.value == 0
        await write(dut, *CONTROL, 1)
        await ClockCycles(dut.fast_clk, offset, FallingEdge)
        rises, sync = 0, 0
        for n in range(80):
            up = int(n < 60 and n % 2 == 0)
            dut.step0__moved.value, dut.step0__up.value, dut.step0__count.value = int(n < 60), up, up
            await FallingEdge(dut.fast_clk)
            rises, sync = rises + (int(dut.sync_out.value) > sync), int(dut.sync_out.value)
        await Timer(800, unit="ns")
        await FallingEdge(dut.clk)
        events = (await watch(dut, INTERRUPT))()
        assert events & 1 == (rises > 0), (offset, rises)
        seen.add((rises, events))
    assert {(1, 1), (1, 5), (2, 1)} <= seen             # of the second armings some were late, some started


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(phase=[0, 1700, 3300, 4900])
async def registers_and_interrupt_are_at_most_12_clocks_old(dut, phase):
    await start(dut, phase)
    worst = {"interrupt": 0, "produced": 0}
    for turn in range(25):
        dut.step0__count.value = 0
        await set_line(dut)
        await write(dut, *CONTROL, 1)
        await Timer(1500, unit="ns")
        await Timer(1 + turn * 11013, unit="ps")            # at all phases of the report's round
        await step(dut, 1)
        await FallingEdge(dut.clk)
        worst["interrupt"] = max(worst["interrupt"],
                                 1 + await clocks_until(dut, lambda: dut.interrupt.value == 1, AGE_CLOCKS))
        await Timer(1 + turn * 9017, unit="ps")
        produced = await watch(dut, PRODUCED)
        assert produced() == 0
        await step(dut, 2)
        await FallingEdge(dut.clk)
        worst["produced"] = max(worst["produced"], 1 + await clocks_until(dut, lambda: produced() == 1, AGE_CLOCKS))
        await Timer(600, unit="ns")                     # finished has come as well
        await FallingEdge(dut.clk)
        await write(dut, *INTERRUPT, 7)
        await FallingEdge(dut.clk)
        assert dut.interrupt.value == 0
    dut._log.info("at most %s clocks old", worst)
    assert max(worst.values()) <= AGE_CLOCKS


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(phase=[0, 1700, 3300, 4900])
async def a_route_reaches_its_pin_within_12_clocks(dut, phase):
    await start(dut, phase)
    worst = 0
    for turn in range(40):
        await ClockCycles(dut.clk, 1 + turn % 23, FallingEdge)
        level = 1 - turn % 2
        await write(dut, "router", 0, level)
        worst = max(worst, 1 + await clocks_until(dut, lambda: dut.out0.value == level, AGE_CLOCKS))
    dut._log.info("at most %d clocks", worst)
    assert worst <= AGE_CLOCKS


def test_in_time(simulate):
    simulate(LinePeripheral())


def test_in_time_with_late_synchronisers(simulate):
    simulate(LinePeripheral(), random_delay=True)
