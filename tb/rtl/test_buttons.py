# SPDX-License-Identifier: BSD-2-Clause
"""rtl/buttons.py: presses of bouncing buttons are counted once, measured, classed and stamped.

A millisecond has 20 clocks here, so that three seconds can be simulated.
"""

import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.buttons import ButtonsPeripheral
from tb.models.contact import bounces
from tb.rtl.register_bus import idle, read, write

LEVELS, EVENTS, DEBOUNCE, LONG, EXTRA_LONG = range(0, 0x14, 4)
PRESS, TIME = 0x20, 0x30
MS = 20                                 # clocks
SYNCHRONISER, EDGE = 2, 1               # clocks from the pin to the debouncer, and from it to the stamp


class Bench:
    """The block, its clocks counted: ``now`` is also what it is given as time."""

    def __init__(self, dut):
        self.dut, self.now = dut, 0xffff_f000
        seed = random.randrange(1 << 32)
        dut._log.info(f"seed {seed}")
        self.rng = random.Random(seed)

    async def start(self, counting=True):
        dut = self.dut
        cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
        idle(dut)
        dut.rst.value, dut.button.value, dut.joystick_button.value, dut.count.value = 1, 0, 0, 0
        await FallingEdge(dut.clk)
        dut.rst.value = 0
        if counting:
            cocotb.start_soon(self._count())
        await self.clocks(self.rng.randrange(MS))

    async def _count(self):
        while True:
            self.dut.count.value = self.now & 0xffff_ffff
            await FallingEdge(self.dut.clk)
            self.now += 1

    async def clocks(self, count):
        if count:
            await ClockCycles(self.dut.clk, count, FallingEdge)

    def put(self, pin, n, level):
        if pin is self.dut.joystick_button:
            pin.value = level
        else:
            pin.value = pin.value.to_unsigned() & ~(1 << n) | level << n

    async def move(self, pin, n, level, longest=MS // 2):
        """Press or release, bouncing; returns when it bounced last."""
        for clocks, bounce in bounces(self.rng, level, 5, longest):
            self.put(pin, n, bounce)
            await self.clocks(clocks)
        self.put(pin, n, level)
        last = self.now
        await self.clocks(1)
        return last

    async def press(self, n, milliseconds, pin=None):
        """Press for a time, wait until the release is believed; returns when it bounced last, press and release."""
        pin = self.dut.button if pin is None else pin
        pressed = await self.move(pin, n, 1)
        await self.clocks(round(milliseconds * MS) - (self.now - pressed))
        released = await self.move(pin, n, 0)
        await self.clocks(12 * MS)
        return pressed, released

    async def result(self, n):
        press = await read(self.dut, PRESS + 4 * n)
        return press & 0xffff, press >> 16, await read(self.dut, TIME + 4 * n)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def presses_are_measured_classed_and_stamped(dut):
    bench = Bench(dut)
    await bench.start()
    assert [await read(dut, a) for a in (DEBOUNCE, LONG, EXTRA_LONG)] == [10, 1000, 3000]
    for milliseconds in (15, 100, 970, 990, 1010, 1500, 2970, 3010, 4000, 200):
        n = bench.rng.randrange(4)
        pressed, released = await bench.press(n, milliseconds)
        assert await read(dut, EVENTS) == 1 << n
        duration, length, time = await bench.result(n)
        held = (released - pressed) / MS
        assert abs(duration - held) <= 1
        assert length == (duration >= 1000) + (duration >= 3000)
        # The level lasted 9 to 10 ms; the stamp is of the clock on which `pressed` is low first.
        late = (time - released) % (1 << 32) - SYNCHRONISER - EDGE
        assert 9 * MS <= late + 1 and late <= 10 * MS
        await write(dut, EVENTS, 0xff)
        await FallingEdge(dut.clk)
        assert await read(dut, EVENTS) == 0


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def what_does_not_last_is_no_press(dut):
    bench = Bench(dut)
    await bench.start()
    for _ in range(20):
        n = bench.rng.randrange(4)
        bench.put(dut.button, n, 1)
        await bench.clocks(bench.rng.randint(1, 9 * MS))
        bench.put(dut.button, n, 0)
        await bench.clocks(bench.rng.randint(1, 5 * MS))
        assert await read(dut, LEVELS) & 0xf == 0
    assert await read(dut, EVENTS) == 0


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_press_is_decided_on_release_only(dut):
    bench = Bench(dut)
    await bench.start()
    await bench.move(dut.button, 1, 1)
    for _ in range(35):
        await bench.clocks(100 * MS)
        assert await read(dut, EVENTS) == 0
        assert await read(dut, LEVELS) == 0x22
    await bench.move(dut.button, 1, 0)
    await bench.clocks(11 * MS)
    assert await read(dut, EVENTS) == 2
    assert (await bench.result(1))[1] == 2


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def the_thresholds_are_settings(dut):
    bench = Bench(dut)
    await bench.start()
    for register, value in ((DEBOUNCE, 2), (LONG, 40), (EXTRA_LONG, 60)):
        await write(dut, register, value)
        await FallingEdge(dut.clk)
    for milliseconds, length in ((38, 0), (42, 1), (58, 1), (62, 2)):
        pressed, released = await bench.press(0, milliseconds)
        duration, got, time = await bench.result(0)
        assert abs(duration - (released - pressed) / MS) <= 1
        # A bounce at the end may carry a press over a threshold.
        assert got == (duration >= 40) + (duration >= 60)
        assert (time - released) % (1 << 32) <= 2 * MS + SYNCHRONISER + EDGE


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def a_second_release_before_the_first_is_cleared_is_lost_and_told(dut):
    bench = Bench(dut)
    await bench.start()
    await bench.press(2, 50)
    assert await read(dut, EVENTS) == 0x04
    await bench.press(2, 80)
    assert await read(dut, EVENTS) == 0x44
    assert abs((await bench.result(2))[0] - 80) <= 10
    await bench.press(3, 30)
    assert await read(dut, EVENTS) == 0x4c


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def buttons_do_not_meddle_with_each_other(dut):
    bench = Bench(dut)
    await bench.start()
    await bench.move(dut.button, 0, 1)
    await bench.clocks(100 * MS)
    for n in (1, 2):
        await bench.press(n, 50)
    await bench.press(3, 50, dut.joystick_button)
    assert await read(dut, EVENTS) == 0x0e
    assert await read(dut, LEVELS) == 0x11
    await bench.move(dut.button, 0, 0)
    await bench.clocks(12 * MS)
    assert await read(dut, EVENTS) == 0x0f
    assert (await bench.result(0))[0] >= 280
    assert all([abs((await bench.result(n))[0] - 50) <= 10 for n in (1, 2, 3)])


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def a_press_longer_than_can_be_told_stays_at_the_most(dut):
    bench = Bench(dut)
    await bench.start(counting=False)
    dut.button.value = 1
    await bench.clocks(65_600 * MS)
    dut.button.value = 0
    await bench.clocks(12 * MS)
    assert (await bench.result(0))[:2] == (65_535, 2)


def test_buttons(simulate):
    simulate(ButtonsPeripheral(millisecond_clocks=MS))


def test_a_millisecond_that_is_none_is_refused():
    with pytest.raises(ValueError, match="at least 2, not 1"):
        ButtonsPeripheral(millisecond_clocks=1)
