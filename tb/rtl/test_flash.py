# SPDX-License-Identifier: BSD-2-Clause
"""rtl/flash.py: frames at the pins of a flash, and those that never get there."""

import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

from rtl.flash import FlashPeripheral
from tb.models.nor import Nor
from tb.rtl.register_bus import idle, read, write

DATA, ADDRESS, FRAME, STATUS, CONTROL, LOWEST = range(0, 0x18, 4)
BUSY, READY, REFUSED = 1, 2, 4
ABORT, LOCK = 1, 2
BITSTREAMS_END, LOCKED_END, JUMP, END = 0x3fe000, 0x400000, 0xfff000, 1 << 24
PROGRAM, READ, READ_STATUS, ENABLE, ERASE, READ_ID, WAKE = 2, 3, 5, 6, 0x20, 0x9f, 0xab


class Bench:
    def __init__(self, dut):
        self.dut, self.nor, self.clock, self.edges = dut, Nor(), 0, []
        seed = random.randrange(1 << 32)
        dut._log.info(f"seed {seed}")
        self.rng = random.Random(seed)

    async def start(self):
        dut = self.dut
        cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
        idle(dut)
        dut.rst.value, dut.miso.value = 1, 1
        await FallingEdge(dut.clk)
        dut.rst.value = 0
        cocotb.start_soon(self._wire())
        await FallingEdge(dut.clk)

    async def _wire(self):
        """Pins change as the clock rises; the flash answers 30 ns later, and until then with any level."""
        dut, level = self.dut, 1
        was = (1, 0)
        while True:
            await FallingEdge(dut.clk)
            self.clock += 1
            dut.miso.value = level
            pins = int(dut.cs_n.value), int(dut.sck.value)
            if pins != was:
                self.edges.append((self.clock, *pins))
                was = pins
            after = self.nor.pins(*pins, int(dut.mosi.value))
            if after != level:
                level = after
                dut.miso.value = self.rng.randrange(2)

    async def clocks(self, count):
        for _ in range(count):
            await FallingEdge(self.dut.clk)

    async def status(self):
        return await read(self.dut, STATUS)

    async def frame(self, opcode, size=0, address=None):
        if address is not None:
            await write(self.dut, ADDRESS, address)
        await write(self.dut, FRAME, opcode | size << 8)
        await self.clocks(1)

    async def over(self):
        for _ in range(40_000):
            if not await self.status() & BUSY:
                return
        raise AssertionError("the frame does not end")

    async def bytes(self, opcode, size, address=None, *, pause=0):
        """The data of a frame that reads."""
        await self.frame(opcode, size, address)
        data = []
        while len(data) < size:
            if await self.status() & READY:
                await self.clocks(self.rng.randrange(pause + 1))
                data += (await read(self.dut, DATA)).to_bytes(4, "little")
        await self.over()
        return bytes(data[:size])

    async def change(self, opcode, address, data=b"", *, pause=0):
        await self.frame(ENABLE)
        await self.over()
        await self.frame(opcode, len(data), address)
        for at in range(0, len(data), 4):
            while not await self.status() & READY:
                pass
            await self.clocks(self.rng.randrange(pause + 1))
            await write(self.dut, DATA, int.from_bytes(data[at:at + 4], "little"))
            await self.clocks(1)
        await self.over()

    async def until_done(self):
        while (await self.bytes(READ_STATUS, 1))[0] & 1:
            pass


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(pause=[0, 200])
async def what_is_programmed_is_read_back(dut, pause):
    bench = Bench(dut)
    await bench.start()
    assert await bench.bytes(READ_ID, 3) == bytes(Nor.IDENTIFICATION)
    wanted = {}
    for _ in range(12):
        address = LOCKED_END + bench.rng.randrange(1 << 16)
        size = bench.rng.randint(1, min(70, 256 - address % 256))
        data = bench.rng.randbytes(size)
        await bench.change(ERASE, address)
        await bench.until_done()
        wanted = {a: v for a, v in wanted.items() if a >> 12 != address >> 12}
        await bench.change(PROGRAM, address, data, pause=pause)
        await bench.until_done()
        wanted |= {address + n: byte for n, byte in enumerate(data)}
        assert await bench.bytes(READ, size, address, pause=pause) == data
    for address in wanted:
        assert await bench.bytes(READ, 1, address) == bytes([wanted[address]])
    assert bench.nor.memory == wanted and not bench.nor.faults


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def nothing_guarded_is_changed(dut):
    """Neither bitstreams nor the jump, ever; nor, from the lock on, what lies between, until a reset."""
    bench = Bench(dut)
    await bench.start()

    async def only_from(lowest):
        await bench.clocks(1)
        assert await read(dut, LOWEST) == lowest
        edges = (0, BITSTREAMS_END, LOCKED_END, JUMP, END)
        for opcode in ERASE, PROGRAM:
            for address in (*(a for edge in edges for a in (edge - 4096, edge - 1, edge) if 0 <= a < END),
                            bench.rng.randrange(lowest), bench.rng.randrange(lowest, JUMP), bench.rng.randrange(JUMP, END)):
                before = len(bench.nor.frames)
                await bench.frame(opcode, 0, address)
                refused = not lowest <= address < JUMP
                assert bool(await bench.status() & REFUSED) == refused and bool(await bench.status() & BUSY) != refused
                await bench.over()
                await bench.clocks(20)
                assert len(bench.nor.frames) == before + (not refused)

    await only_from(BITSTREAMS_END)
    await write(dut, CONTROL, ABORT)
    await only_from(BITSTREAMS_END)
    await write(dut, CONTROL, LOCK)
    await only_from(LOCKED_END)
    for word in 0, ABORT:
        await write(dut, CONTROL, word)
        await only_from(LOCKED_END)
    for address in 0, JUMP:                                     # may be read
        assert await bench.bytes(READ, 4, address) == b"\xff" * 4
    dut.rst.value = 1
    await bench.clocks(1)
    dut.rst.value = 0
    await only_from(BITSTREAMS_END)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_lock_lets_the_frame_under_way_end(dut):
    bench = Bench(dut)
    await bench.start()
    await bench.frame(ENABLE)
    await bench.over()
    await bench.frame(PROGRAM, 4, BITSTREAMS_END)
    await write(dut, CONTROL, LOCK)
    await write(dut, DATA, 0x01020304)
    await bench.over()
    assert bench.nor.memory == {BITSTREAMS_END + n: 4 - n for n in range(4)}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def only_frames_that_are_known_leave(dut):
    bench = Bench(dut)
    await bench.start()
    known = {PROGRAM, READ, READ_STATUS, ENABLE, ERASE, READ_ID, WAKE}
    for opcode in range(256):
        before = len(bench.nor.frames)
        await bench.frame(opcode, 0, LOCKED_END)
        assert bool(await bench.status() & REFUSED) == (opcode not in known)
        await bench.over()
        assert len(bench.nor.frames) == before + (opcode in known)
    assert {frame[0] for frame in bench.nor.frames} == known
    lengths = {frame[0]: len(frame) for frame in bench.nor.frames}
    assert lengths == {PROGRAM: 4, READ: 4, READ_STATUS: 1, ENABLE: 1, ERASE: 4, READ_ID: 1, WAKE: 1}


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_frame_in_another_is_refused_and_does_not_harm_it(dut):
    bench = Bench(dut)
    await bench.start()
    bench.nor.memory = {LOCKED_END + n: n for n in range(8)}
    await bench.frame(READ, 8, LOCKED_END)
    await bench.frame(ERASE, 0, LOCKED_END)
    assert await bench.status() & (BUSY | REFUSED) == BUSY | REFUSED
    data = b""
    while len(data) < 8:
        if await bench.status() & READY:
            data += (await read(dut, DATA)).to_bytes(4, "little")
    assert data == bytes(range(8))
    await bench.over()
    await bench.frame(READ_ID)
    assert not await bench.status() & REFUSED


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_frame_waits_for_its_data_and_can_be_given_up(dut):
    bench = Bench(dut)
    await bench.start()
    await bench.frame(READ, 100, LOCKED_END)
    await bench.clocks(3000)
    edges = len(bench.edges)
    await bench.clocks(3000)
    assert await bench.status() == BUSY | READY and len(bench.edges) == edges and bench.edges[-1][1:] == (0, 0)
    await write(dut, CONTROL, ABORT)
    await bench.clocks(6)
    assert bench.edges[-1][1:] == (1, 0)
    await bench.clocks(8)
    assert not await bench.status() & BUSY
    assert await bench.bytes(READ_ID, 3) == bytes(Nor.IDENTIFICATION)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_clock_keeps_its_times(dut):
    """12.5 MHz, whole periods, a select that frames them, and a megabyte and a half a second."""
    bench = Bench(dut)
    await bench.start()
    began = bench.clock
    await bench.bytes(READ, 256, LOCKED_END)
    spent = bench.clock - began
    rises = [clock for clock, cs_n, sck in bench.edges if not cs_n and sck]
    falls = [clock for clock, cs_n, sck in bench.edges if not cs_n and not sck]
    assert len(rises) == 8 * (4 + 256)
    assert min(b - a for a, b in zip(rises, rises[1:])) == 4
    assert all(fall - rise == 2 for rise, fall in zip(rises, falls[1:]))
    selected, deselected = bench.edges[0][0], bench.edges[-1][0]
    assert rises[0] - selected >= 2 and deselected - falls[-1] >= 2
    assert max(b - a for a, b in zip(rises, rises[1:])) <= 4 + 4
    assert spent <= 8 * 4 * 260 + 4 * 260 + 40
    dut._log.info(f"{256 * 50 / spent:.2f} MB/s")


def test_peripheral(simulate):
    simulate(FlashPeripheral())
