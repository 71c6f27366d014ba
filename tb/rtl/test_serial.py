# SPDX-License-Identifier: BSD-2-Clause
"""rtl/serial.py: bytes go in and out unharmed, and what is not a byte is told apart and reported."""

import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, Timer
from cocotb.utils import get_sim_time

from rtl.serial import SerialPeripheral
from tb.rtl import register_bus
from tb.rtl.register_bus import idle

DATA, STATUS, ERRORS, ERROR_COUNT, DIVISOR, ENABLE = range(0, 0x18, 4)
RX_READY, TX_READY, TX_LOW, TX_IDLE = 1, 2, 4, 8
OVERRUN, FRAMING, BREAK = 1, 2, 4
ENABLE_RX, ENABLE_TX, ENABLE_ERROR = 1, 2, 4
VALID = 0x100
CLOCK_NS = 20
DEPTH = 64


class Port:
    """The block, and the far end of its two wires."""

    def __init__(self, dut, divisor=16):
        self.dut, self.divisor, self.received = dut, divisor, []

    async def start(self):
        dut = self.dut
        seed = random.randrange(1 << 32)
        dut._log.info(f"seed {seed}")
        self.rng = random.Random(seed)
        cocotb.start_soon(Clock(dut.clk, CLOCK_NS, unit="ns").start())
        idle(dut)
        dut.rx.value, dut.rst.value = 1, 1
        await ClockCycles(dut.clk, 2, FallingEdge)
        assert dut.tx.value == 1
        dut.rst.value = 0
        assert await self.read(DIVISOR) == 434
        await self.write(DIVISOR, self.divisor)
        self.bit_ns = max(self.divisor, 8) * CLOCK_NS
        cocotb.start_soon(self._receive())

    async def write(self, offset, value):
        await FallingEdge(self.dut.clk)
        await register_bus.write(self.dut, offset, value)
        await FallingEdge(self.dut.clk)

    async def read(self, offset):
        await FallingEdge(self.dut.clk)
        return await register_bus.read(self.dut, offset)

    async def send(self, data, *, stop=1, rate=1.0):
        """Drive one frame onto ``rx``; ``rate`` is the far end's bit rate error."""
        for bit in [0, *(data >> n & 1 for n in range(8)), stop]:
            self.dut.rx.value = bit
            await Timer(round(self.bit_ns / rate * 1000), unit="ps")
        self.dut.rx.value = 1

    async def _receive(self):
        """Collect ``(byte, stop bit, time of the start bit)`` from ``tx``, sampled in the middle of each bit."""
        while True:
            if self.dut.tx.value != 0:
                await self.dut.tx.falling_edge
            at = get_sim_time("ns")
            await Timer(self.bit_ns // 2, unit="ns")
            bits = []
            for _ in range(9):
                await Timer(self.bit_ns, unit="ns")
                bits.append(int(self.dut.tx.value))
            self.received.append((sum(bit << n for n, bit in enumerate(bits[:8])), bits[8], at))
            while self.dut.tx.value == 0:
                await FallingEdge(self.dut.clk)

    async def drain(self):
        """Everything in the receive FIFO."""
        result = []
        while (value := await self.read(DATA)) & VALID:
            result.append(value & 0xff)
        return result

    async def wait_idle(self):
        for _ in range(200 * 12 * self.divisor):
            if await self.read(STATUS) & TX_IDLE:
                return
        raise AssertionError("never idle")


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize((("divisor", "rate"), [
    (8, 1.0), (16, 0.97), (16, 1.0), (16, 1.03), (434, 0.97), (434, 1.0), (434, 1.03)]))
async def receives_every_byte_in_order(dut, divisor, rate):
    port = Port(dut, divisor)
    await port.start()
    data = [0x00, 0xff, 0x55, 0xaa, 0x01, 0x80] + [port.rng.randrange(256) for _ in range(20)]
    for byte in data:
        await port.send(byte, rate=rate)
    await Timer(2 * port.bit_ns, unit="ns")
    assert await port.drain() == data
    assert await port.read(ERRORS) == 0 and await port.read(ERROR_COUNT) == 0
    assert not await port.read(DATA) & VALID        # empty


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(divisor=[3, 8, 16, 434])
async def sends_every_byte_in_order(dut, divisor):
    port = Port(dut, divisor)                       # 3 acts as 8
    await port.start()
    data = [0x00, 0xff, 0x55] + [port.rng.randrange(256) for _ in range(20)]
    for byte in data:
        await port.write(DATA, byte)
    await port.wait_idle()
    idle_at = get_sim_time("ns")
    await Timer(3 * port.bit_ns, unit="ns")
    assert [(byte, stop) for byte, stop, _ in port.received] == [(byte, 1) for byte in data]
    # A frame is 10 bits, and at most one clock more; idle not before the last stop bit has ended.
    starts = [at for *_, at in port.received]
    assert {b - a for a, b in zip(starts, starts[1:])} <= {10 * port.bit_ns, 10 * port.bit_ns + CLOCK_NS}
    end = starts[-1] + 10 * port.bit_ns
    assert end <= idle_at <= end + 8 * CLOCK_NS


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def both_ways_at_once(dut):
    port = Port(dut)
    await port.start()
    inward = [port.rng.randrange(256) for _ in range(40)]
    outward = [port.rng.randrange(256) for _ in range(40)]
    for byte in outward:
        await port.write(DATA, byte)
    for byte in inward:
        await port.send(byte)
    await port.wait_idle()
    await Timer(3 * port.bit_ns, unit="ns")
    assert await port.drain() == inward
    assert [byte for byte, *_ in port.received] == outward


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_full_fifo_keeps_the_old_bytes_and_says_so(dut):
    port = Port(dut, 8)
    await port.start()
    data = [port.rng.randrange(256) for _ in range(DEPTH + 6)]
    for n, byte in enumerate(data):
        await port.send(byte)
        await Timer(2 * port.bit_ns, unit="ns")
        assert await port.read(ERRORS) == (OVERRUN if n >= DEPTH else 0)
    assert await port.drain() == data[:DEPTH]
    assert await port.read(ERRORS) == OVERRUN
    await port.write(ERRORS, OVERRUN)
    assert await port.read(ERRORS) == 0
    await port.send(0x5a)
    await Timer(port.bit_ns, unit="ns")
    assert await port.drain() == [0x5a]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_full_transmit_fifo_is_seen_before_anything_is_lost(dut):
    port = Port(dut, 64)
    await port.start()
    sent = []
    for n in range(DEPTH + 40):
        status = await port.read(STATUS)
        if status & TX_READY:
            sent.append(n & 0xff)
            await port.write(DATA, n & 0xff)
    # FIFO, and the one the transmitter has taken.
    assert DEPTH <= len(sent) <= DEPTH + 2
    assert not await port.read(STATUS) & (TX_READY | TX_LOW | TX_IDLE)
    await port.write(DATA, 0xee)                    # no room: lost
    await port.wait_idle()
    await Timer(3 * port.bit_ns, unit="ns")
    assert [byte for byte, *_ in port.received] == sent


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_break_of_any_length_is_one_error_and_no_byte(dut):
    port = Port(dut)
    await port.start()
    for count, bits in enumerate((10.5, 11, 19, 25, 100, 333.3), 1):
        dut.rx.value = 0
        await Timer(round(bits * port.bit_ns), unit="ns")
        dut.rx.value = 1
        await Timer(2 * port.bit_ns, unit="ns")
        assert await port.read(ERRORS) == BREAK
        await port.write(ERRORS, BREAK)
        assert await port.read(ERROR_COUNT) == count
        await port.send(0xc3)
        await Timer(port.bit_ns, unit="ns")
        assert await port.drain() == [0xc3]
        assert await port.read(ERRORS) == 0


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_frame_without_stop_bit_is_dropped_and_counted(dut):
    port = Port(dut)
    await port.start()
    for n, byte in enumerate((0x41, 0xff, 0x80, 0x01), 1):
        await port.send(byte, stop=0)
        await Timer(2 * port.bit_ns, unit="ns")
        assert await port.read(ERRORS) == FRAMING
        await port.write(ERRORS, FRAMING)
        assert await port.read(ERROR_COUNT) == n
        await port.send(0x42)
        await Timer(port.bit_ns, unit="ns")
        assert await port.drain() == [0x42]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_new_divisor_is_taken_at_the_next_bit(dut):
    port = Port(dut, 40)
    await port.start()
    await port.write(DATA, 0x55)                    # 0 1 0 1 0 1 0 1 0 1 with start and stop bit
    clocks, edges = 0, []
    level = 1
    while len(edges) < 6:
        await FallingEdge(dut.clk)
        clocks += 1
        if dut.tx.value != level:
            level = int(dut.tx.value)
            edges.append(clocks)
            if len(edges) == 3:                     # early in the second data bit: it keeps its length
                dut.bus__addr.value, dut.bus__w_data.value, dut.bus__w_stb.value = DIVISOR // 4, 16, 1
                await FallingEdge(dut.clk)
                dut.bus__w_stb.value = 0
                clocks += 1
    assert [b - a for a, b in zip(edges, edges[1:])] == [40, 40, 40, 16, 16]


@cocotb.test(timeout_time=4000, timeout_unit="ms")
async def the_count_of_dropped_frames_stays_at_65535(dut):
    """As fast as frames go: 8 clocks a bit, the line low for a frame and high for a little."""
    port = Port(dut, 8)
    await port.start()

    async def drop(frames):
        for _ in range(frames):
            dut.rx.value = 0
            await Timer(84 * CLOCK_NS, unit="ns")
            dut.rx.value = 1
            await Timer(12 * CLOCK_NS, unit="ns")

    await drop(65534)
    assert await port.read(ERROR_COUNT) == 65534
    for count in (65535, 65535, 65535):
        await drop(1)
        assert await port.read(ERROR_COUNT) == count
    assert await port.read(ERRORS) == BREAK and await port.drain() == []


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_spike_is_no_byte(dut):
    port = Port(dut)
    await port.start()
    dut.rx.value = 0
    await Timer(port.bit_ns // 4, unit="ns")
    dut.rx.value = 1
    await Timer(12 * port.bit_ns, unit="ns")
    assert await port.drain() == []
    assert await port.read(ERRORS) == FRAMING


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def each_condition_interrupts_when_enabled_and_only_then(dut):
    port = Port(dut)
    await port.start()
    await port.send(0x31)
    await port.send(0x32, stop=0)
    await Timer(2 * port.bit_ns, unit="ns")
    for enable, expected in ((0, 0), (ENABLE_RX, 1), (ENABLE_TX, 1), (ENABLE_ERROR, 1)):
        await port.write(ENABLE, enable)
        assert dut.interrupt.value == expected
    await port.write(ERRORS, FRAMING)
    assert dut.interrupt.value == 0                 # only the error was enabled
    await port.write(ENABLE, ENABLE_RX)
    assert dut.interrupt.value == 1
    assert await port.drain() == [0x31]
    assert dut.interrupt.value == 0
    await port.write(ENABLE, ENABLE_TX)
    for _ in range(DEPTH // 2 + 2):
        await port.write(DATA, 0)
    assert dut.interrupt.value == 0
    for _ in range(3 * 12 * port.divisor):
        await FallingEdge(dut.clk)
    assert dut.interrupt.value == 1                 # half empty again


def test_serial(simulate):
    simulate(SerialPeripheral())


def test_a_fifo_too_short_is_refused():
    with pytest.raises(ValueError, match="at least 64, not 32"):
        SerialPeripheral(depth=32)
