# SPDX-License-Identifier: BSD-2-Clause
"""rtl/adc.py: all channels of a converter after each tick, shown together at the next, whatever the converter's habits."""

import os
import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge
from cocotb.utils import get_sim_time

from rtl.adc import AdcPeripheral
from tb.models.adc import Adc
from tb.rtl.register_bus import idle, read, write

STATUS, CONTROL, EVENTS = 0x20, 0x24, 0x28
VALID, IDLE_HIGH = 1, 2
FAILED, OVERRUN = 1, 2
FRAME = 144                             # clocks
SCAN, CONFIGURE = 11 * FRAME, 5 * FRAME
CLOCK_NS = 20

HABITS = eval(os.environ.get("HABITS", "{}"))


class Bench:
    def __init__(self, dut, adc):
        self.dut, self.adc, self.fall_ns = dut, adc, []
        seed = random.randrange(1 << 32)
        dut._log.info(f"seed {seed}")
        self.rng = random.Random(seed)

    async def start(self):
        dut = self.dut
        cocotb.start_soon(Clock(dut.clk, CLOCK_NS, unit="ns").start())
        idle(dut)
        dut.rst.value, dut.tick.value, dut.miso.value = 1, 0, 1
        await FallingEdge(dut.clk)
        dut.rst.value = 0
        cocotb.start_soon(self._wire())
        await FallingEdge(dut.clk)
        await write(dut, CONTROL, 1)
        await FallingEdge(dut.clk)

    async def _wire(self):
        """Pins change at rising edges of the clock; the converter's answer is there at the next one, or is no level."""
        dut, cs_n = self.dut, 1
        while True:
            await FallingEdge(dut.clk)
            now = get_sim_time("ns")
            changed = now - CLOCK_NS / 2
            if self.adc is None:
                continue
            self.adc.pins(changed, int(dut.cs_n.value), int(dut.sck.value), int(dut.mosi.value))
            if cs_n and not int(dut.cs_n.value):
                self.fall_ns.append(round(changed))
            cs_n = int(dut.cs_n.value)
            level = self.adc.dout(now)
            dut.miso.value = level if level != 2 else self.rng.randrange(2)

    async def tick(self):
        self.dut.tick.value = 1
        await FallingEdge(self.dut.clk)
        self.dut.tick.value = 0
        return round(get_sim_time("ns") - CLOCK_NS / 2)     # the edge that took it

    async def clocks(self, count):
        await ClockCycles(self.dut.clk, count, FallingEdge)

    async def channels(self):
        return [await read(self.dut, 4 * n) for n in range(8)]

    async def settle(self):
        """Ticks until a scan is shown."""
        for _ in range(4):
            await self.tick()
            await self.clocks(SCAN + CONFIGURE + 10)
        await self.tick()
        await self.clocks(1)
        assert await read(self.dut, STATUS) & VALID
        await write(self.dut, EVENTS, FAILED | OVERRUN)
        await self.clocks(SCAN + 10)

    def draw(self):
        """New levels at the inputs; what they are to be read as."""
        bits = HABITS.get("bits", 12)
        codes = [self.rng.randrange(1 << bits) for _ in range(8)]
        self.adc.inputs = [(code + 0.5) / (1 << bits) for code in codes]
        return [code << 12 - bits for code in codes]


def converter():
    return Adc(**HABITS)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def each_tick_shows_the_scan_of_the_tick_before(dut):
    bench = Bench(dut, converter())
    await bench.start()
    await bench.settle()
    expected = None
    for n in range(12):
        await bench.tick()
        await bench.clocks(1)
        shown = await bench.channels()
        if n:
            assert shown == expected
        assert await read(dut, STATUS) & VALID
        expected = bench.draw()
        await bench.clocks(SCAN)
        assert await bench.channels() == shown              # still, during the scan and after it
    assert await read(dut, EVENTS) == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_converter_is_configured_as_the_data_sheet_says(dut):
    bench = Bench(dut, converter())
    await bench.start()
    await bench.settle()
    assert bench.adc.registers == {"config": 0, "unipolar": 0, "bipolar": 0, "range": 0}
    # Once it answers, scans are conversions only: of every channel, in order, and three more of the last one.
    bench.adc.frames.clear()
    await bench.tick()
    await bench.clocks(SCAN + 10)
    assert [word >> 7 & 0xf for word in bench.adc.frames] == [0, 1, 2, 3, 4, 5, 6, 7, 7, 7, 7]
    assert all(word & 0xf844 == 0x0804 for word in bench.adc.frames)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def channels_are_converted_at_constant_times_after_the_tick(dut):
    bench = Bench(dut, converter())
    await bench.start()
    await bench.settle()
    for _ in range(3):
        await bench.clocks(bench.rng.randrange(500))
        bench.fall_ns.clear()
        tick = await bench.tick()
        await bench.clocks(SCAN + 10)
        assert [(at - tick) / CLOCK_NS for at in bench.fall_ns] == [1 + FRAME * n for n in range(11)]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def ticks_as_close_as_a_scan_are_served_and_closer_ones_told(dut):
    bench = Bench(dut, converter())
    await bench.start()
    await bench.settle()
    await bench.tick()
    for _ in range(3):
        expected = bench.draw()
        await bench.clocks(SCAN)
        await bench.tick()
        await bench.clocks(1)
        assert await read(dut, EVENTS) == 0 and await read(dut, STATUS) & VALID
        assert await bench.channels() == expected
        bench.draw()
        await bench.clocks(SCAN - 30)
        await bench.tick()                                  # too early
        await bench.clocks(1)
        assert await read(dut, EVENTS) == OVERRUN and not await read(dut, STATUS) & VALID
        assert await bench.channels() == expected           # kept
        await write(dut, EVENTS, OVERRUN)
        await bench.clocks(40)
        await bench.tick()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_converter_that_lost_its_settings_is_configured_again(dut):
    bench = Bench(dut, converter())
    await bench.start()
    await bench.settle()
    await bench.tick()
    await bench.clocks(3 * FRAME)
    bench.adc.power_up()
    bench.adc.frames.clear()
    kept = await bench.channels()
    # It goes on being told what to convert, and so goes on; what it forgot is made good if it no longer answers.
    await bench.clocks(SCAN)
    bench.adc._mode = bench.adc._channel = 0
    answers, bench.adc._convert = bench.adc._convert, lambda now: 0xffff
    for _ in range(2):
        await bench.tick()
        await bench.clocks(SCAN + CONFIGURE + 10)
    assert await read(dut, EVENTS) & FAILED
    await bench.tick()
    await bench.clocks(1)
    assert not await read(dut, STATUS) & VALID
    bench.adc._convert = answers
    await bench.clocks(SCAN + CONFIGURE + 10)
    await bench.settle()
    expected = bench.draw()
    await bench.tick()
    await bench.clocks(SCAN + 10)
    await bench.tick()
    await bench.clocks(1)
    assert await bench.channels() == expected != kept
    assert 0x0040 in bench.adc.frames


@pytest.mark.parametrize("habits", [
    {}, {"latency": 2}, {"latency": 3}, {"first_edge": True}, {"first_edge": True, "latency": 3}, {"bits": 10},
    {"bits": 8}], ids=lambda habits: " ".join(f"{name} {value}" for name, value in habits.items()) or "usual")
def test_adc(simulate, habits):
    simulate(AdcPeripheral(), tests="each|the_conv|channels|ticks|a_conv", env={"HABITS": repr(habits)})


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def without_a_converter_nothing_is_valid(dut):
    bench = Bench(dut, None)
    await bench.start()
    for level in (0, 1):
        dut.miso.value = level
        for _ in range(4):
            await bench.tick()
            await bench.clocks(SCAN + CONFIGURE + 10)
            assert await read(dut, EVENTS) == FAILED
            await write(dut, EVENTS, FAILED)
            assert not await read(dut, STATUS) & VALID
    assert await bench.channels() == [0] * 8


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def without_enable_the_pins_are_still(dut):
    bench = Bench(dut, None)
    await bench.start()
    await write(dut, CONTROL, 0)
    await bench.clocks(1)
    await bench.tick()
    for _ in range(3 * FRAME):
        await FallingEdge(dut.clk)
        assert (dut.cs_n.value, dut.sck.value, dut.mosi.value) == (1, 0, 0)


def test_adc_absent(simulate):
    simulate(AdcPeripheral(), tests="without")
