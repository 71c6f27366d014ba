# SPDX-License-Identifier: BSD-2-Clause
"""soc/ecp5.py: the reset of both domains changes only while neither has clock edges, and motors stay off meanwhile.

The PLL and the clock gates are modelled here: the clocks run at their ratio or not at all, and a gate acts at a
falling edge of its own clock (Lattice FPGA-TN-02200, "Dynamic Clock Control").
"""

import cocotb
import pytest
from amaranth import ClockDomain, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, Timer
from cocotb.utils import get_sim_time

from rtl.crossing import StrobeCrossing
from soc.ecp5 import ResetSequencer

HOLD, QUIET = 24, 4                     # clocks of 40 ns; the least hold that gives 3 clocks of 20 ns is far less
BOARD_PS, SYNC_PS, FAST_PS = 40_000, 20_000, 5_000


class Domains(wiring.Component):
    """Two domains under a sequencer.  Each sends an event to the other on its first clock and counts what arrives;
    ``motor`` is driven from the first clock on, behind ``safe``, as the controller's pins are."""

    board_clk: In(1)
    sync_clk: In(1)
    fast_clk: In(1)
    locked: In(1)
    request: In(1)
    reset: Out(1)
    run: Out(1)
    safe: Out(1)
    motor: Out(1)
    sync_count: Out(8)
    fast_count: Out(8)

    def elaborate(self, platform):
        m = Module()
        m.submodules.sequencer = sequencer = ResetSequencer(hold_clocks=HOLD, quiet_clocks=QUIET)
        m.d.comb += [
            sequencer.locked.eq(self.locked), sequencer.request.eq(self.request),
            self.reset.eq(sequencer.reset), self.run.eq(sequencer.run), self.safe.eq(sequencer.safe),
        ]
        board = ClockDomain("board", reset_less=True)
        m.domains += board
        m.d.comb += board.clk.eq(self.board_clk)
        for name, other in ("sync", "fast"), ("fast", "sync"):
            domain = ClockDomain(name)
            m.domains += domain
            m.d.comb += [domain.clk.eq(getattr(self, f"{name}_clk")), domain.rst.eq(sequencer.reset)]
            m.submodules[f"from_{name}"] = crossing = StrobeCrossing(source=name, destination=other)
            sent, count = Signal(name=f"{name}_sent"), getattr(self, f"{other}_count")
            m.d[name] += sent.eq(1)
            m.d.comb += crossing.i.eq(~sent)
            m.d[other] += count.eq(count + crossing.o)
        driven = Signal()
        m.d.sync += driven.eq(1)
        m.d.comb += self.motor.eq(driven & ~sequencer.safe)
        return m


class Pll:
    """Both clocks, gated by ``run``; counts their edges and watches that none comes near a change of reset."""

    def __init__(self, dut):
        self.dut, self.edges, self.last_edge, self.running = dut, {"sync": 0, "fast": 0}, 0, True
        self.changes = 0
        for name, period in ("sync", SYNC_PS), ("fast", FAST_PS):
            cocotb.start_soon(self._clock(name, period))
        cocotb.start_soon(self._watch())

    async def _clock(self, name, period):
        pin = getattr(self.dut, f"{name}_clk")
        pin.value = 0
        while True:
            await Timer(period // 2, unit="ps")
            enabled = self.running and int(self.dut.run.value)      # the gate's latch, open while the clock is low
            if enabled:
                pin.value = 1
                self.edges[name] += 1
                self.last_edge = get_sim_time("ps")
            await Timer(period // 2, unit="ps")
            pin.value = 0

    async def _watch(self):
        """A change of reset: quiet before it and after it, for most of QUIET."""
        await Timer(1, unit="ps")                       # the simulator's own settling at time 0
        while True:
            await self.dut.reset.value_change
            self.changes += 1
            changed, before = get_sim_time("ps"), dict(self.edges)
            assert changed - self.last_edge > (QUIET - 2) * BOARD_PS
            await Timer((QUIET - 2) * BOARD_PS, unit="ps")
            assert self.edges == before


async def start(dut):
    """Power up: the PLL not locked yet, the board's oscillator running for a while."""
    dut.locked.value, dut.request.value, dut.board_clk.value = 0, 0, 0
    cocotb.start_soon(Clock(dut.board_clk, BOARD_PS, unit="ps").start())
    pll = Pll(dut)
    await board_clocks(dut, 3 * HOLD)
    assert int(dut.reset.value) and int(dut.safe.value) and not int(dut.motor.value)
    pll.changes = 0
    return pll


async def board_clocks(dut, count):
    for _ in range(count):
        await FallingEdge(dut.board_clk)


async def until_running(dut):
    while int(dut.safe.value):
        await FallingEdge(dut.board_clk)


def check_restarted(dut):
    """One event arrived each way, no other."""
    assert int(dut.sync_count.value) == 1 and int(dut.fast_count.value) == 1


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def power_up_waits_for_lock_then_restarts_both_domains(dut):
    pll = await start(dut)
    dut.locked.value = 1
    locked, edges = get_sim_time("ps"), dict(pll.edges)
    await FallingEdge(dut.reset)
    held = (get_sim_time("ps") - locked) // BOARD_PS
    assert HOLD + QUIET <= held <= HOLD + QUIET + 4
    assert pll.edges["sync"] - edges["sync"] >= 3 and pll.edges["fast"] - edges["fast"] >= 12
    await until_running(dut)
    await board_clocks(dut, 10)
    check_restarted(dut)
    assert int(dut.motor.value) and pll.changes == 1


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(cause=["request", "locked"], phase_ps=[0, 7_000, 13_333, 21_250, 39_000])
async def the_button_and_a_lost_lock_restart_both_domains_at_any_time(dut, cause, phase_ps):
    pll = await start(dut)
    dut.locked.value = 1
    await until_running(dut)
    await board_clocks(dut, 20)
    await Timer(phase_ps + 1, unit="ps")
    getattr(dut, cause).value = cause == "request"
    if cause == "locked":
        pll.running = False                             # the worst a PLL can do: its clocks stop where they are
    await board_clocks(dut, 4)                          # 1 until sampled, 3 until it acts
    assert int(dut.safe.value) and not int(dut.motor.value)
    await board_clocks(dut, 3 * HOLD)
    assert int(dut.reset.value) and not int(dut.motor.value)
    pll.running = True
    getattr(dut, cause).value = cause == "locked"
    await until_running(dut)
    await board_clocks(dut, 10)
    check_restarted(dut)
    assert pll.changes == 3


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_bouncing_button_leaves_reset_only_when_it_is_still(dut):
    await start(dut)
    dut.locked.value = 1
    await until_running(dut)
    for level in [1, 0] * 20:
        dut.request.value = level
        await board_clocks(dut, HOLD // 2)
        assert int(dut.safe.value) or level             # only the first press may find it still running
    await until_running(dut)
    await board_clocks(dut, 10)
    check_restarted(dut)


def test_reset(simulate):
    simulate(Domains())


@pytest.mark.parametrize("name", ["hold_clocks", "quiet_clocks"])
@pytest.mark.parametrize("value", [0, -1, 1.5])
def test_a_wait_of_no_clocks_is_refused(name, value):
    with pytest.raises(ValueError, match=name):
        ResetSequencer(**{"hold_clocks": 1, "quiet_clocks": 1} | {name: value})
