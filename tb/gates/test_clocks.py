# SPDX-License-Identifier: BSD-2-Clause
"""soc/ecp5.py, ClockGenerator, as netlist with the model of the PLL: frequencies, phase, and the order of a reset."""

import sys

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, Timer, ValueChange
from cocotb.utils import get_sim_time

from soc.ecp5 import ClockGenerator
from tb import toolchain, verilated
from tb.gates import netlist

pytestmark = pytest.mark.gates

OSCILLATOR_PS, FAST_PS, SYNC_PS = 40_000, 5_000, 20_000
QUIET_PS = 1000 * ClockGenerator.QUIET_NS


def now():
    return round(get_sim_time("ps"))


class Bench:
    """The oscillator, and when every output changed."""

    def __init__(self, dut):
        self.dut, self.edges = dut, {name: [] for name in ("fast_clk", "sync_clk", "reset", "safe")}
        self.rises = []

    async def start(self):
        self.clock = Clock(self.dut.oscillator, OSCILLATOR_PS, unit="ps")
        self.clock.start()
        self.dut.request.value = 1              # the test before may have left it running
        await Timer(20_000, unit="ns")
        self.dut.request.value = 0
        for name, edges in self.edges.items():
            cocotb.start_soon(self._record(getattr(self.dut, name), edges))
        await FallingEdge(self.dut.safe)

    async def _record(self, handle, edges):
        while True:
            await ValueChange(handle)
            edges.append((now(), int(handle.value)))

    def levels(self, name, level, since=0):
        return [time for time, value in self.edges[name] if value == level and time >= since]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def clocks_have_their_frequency_and_rise_with_the_oscillator(dut):
    bench = Bench(dut)
    await bench.start()
    await RisingEdge(dut.oscillator)
    since = now()
    await Timer(10_000, unit="ns")
    for name, period in ("fast_clk", FAST_PS), ("sync_clk", SYNC_PS):
        rises, falls = bench.levels(name, 1, since + 1), bench.levels(name, 0, since + 1)
        assert {b - a for a, b in zip(rises, rises[1:])} == {period}
        assert {(time - since) % period for time in rises} == {0}
        assert {(time - since) % period for time in falls} == {period // 2}


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def no_clock_runs_near_a_change_of_reset(dut):
    bench = Bench(dut)
    await bench.start()
    for _ in range(2):
        await Timer(20_003, unit="ns")
        dut.request.value = 1
        await RisingEdge(dut.safe)
        await Timer(3_000, unit="ns")
        dut.request.value = 0
        await FallingEdge(dut.safe)
    await Timer(2_000, unit="ns")
    changes = [time for time, _ in bench.edges["reset"]][-4:]
    assert len(changes) == 4
    for name, period in ("fast_clk", FAST_PS), ("sync_clk", SYNC_PS):
        rises = bench.levels(name, 1)
        for change in changes:
            # A clock stops a period after the end of ``run`` at most.
            assert not [r for r in rises if abs(r - change) <= QUIET_PS - 2 * OSCILLATOR_PS]
        # And there are clocks in reset, and no short ones at all.
        for start, end in zip(changes[::2], changes[1::2]):
            assert sum(start < r < end for r in rises) >= 3
        both = [time for time, _ in bench.edges[name]]
        assert min(b - a for a, b in zip(both, both[1:])) == period // 2


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def without_an_oscillator_the_lock_and_the_clocks_stop(dut):
    bench = Bench(dut)
    await bench.start()
    await Timer(5_000, unit="ns")
    bench.clock.stop()
    dut.oscillator.value = 0
    await Timer(1_000, unit="ns")
    for edges in bench.edges.values():
        edges.clear()
    await Timer(5_000, unit="ns")
    assert not bench.edges["fast_clk"] and not bench.edges["sync_clk"]
    bench.clock.start()
    back = now()
    await FallingEdge(dut.safe)
    await Timer(1, unit="ns")
    # With the first clocks of the oscillator all outputs are off, and do not return before a reset.
    (off, _), (on, _) = bench.edges["safe"]
    assert off - back <= 4 * OSCILLATOR_PS
    assert [level for time, level in bench.edges["reset"] if off < time < on] == [1, 0]


def test_clock_generator():
    component = ClockGenerator(input_hz=25_000_000, sync_hz=50_000_000, fast_hz=200_000_000)
    directory = netlist.build(toolchain.to_rtlil(component), timing=True)
    assert not verilated.failures(directory, sys.modules[__name__], label="clocks")
