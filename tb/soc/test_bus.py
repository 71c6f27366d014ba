# SPDX-License-Identifier: BSD-2-Clause
"""soc/bus.py and soc/memory.py: accesses take the clocks that are promised, and end in ``err`` where they must."""

import cocotb
import pytest
from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, connect, flipped
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from rtl.registers import Field, Register, RegisterBank, action, csr
from soc.bus import BusTimeout, RegisterBridge
from soc.cpu import BUS
from soc.memory import BusPort, Region
from amaranth_soc import wishbone

CLASSIC, INCREMENT, END = 0b000, 0b010, 0b111


async def start(dut, prefix="bus"):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    for pin in "adr", "cyc", "stb", "we", "sel", "dat_w", "cti", "bte":
        if hasattr(dut, f"{prefix}__{pin}"):
            getattr(dut, f"{prefix}__{pin}").value = 0
    dut.rst.value = 1
    await FallingEdge(dut.clk)
    dut.rst.value = 0
    await FallingEdge(dut.clk)


async def access(dut, address, *, write=None, select=0xf, cycle_type=None, prefix="bus", limit=100):
    """One access from a falling edge on; returns ``(clocks, "ack" or "err", data)``.  Leaves the strobe on."""
    def pin(name):
        return getattr(dut, f"{prefix}__{name}")
    pin("adr").value, pin("cyc").value, pin("stb").value = address >> 2, 1, 1
    pin("we").value, pin("sel").value, pin("dat_w").value = write is not None, select, write or 0
    if cycle_type is not None:
        pin("cti").value = cycle_type
    for clocks in range(1, limit):
        await FallingEdge(dut.clk)
        # The level now is what the processor samples at the end of this clock.
        if pin("ack").value or pin("err").value:
            result = clocks + 1, "ack" if pin("ack").value else "err", pin("dat_r").value.to_unsigned()
            assert not (pin("ack").value and pin("err").value)
            await FallingEdge(dut.clk)
            return result
    return None


async def line_fill(dut, address):
    """A burst of 8 words; returns ``(clocks, data)``."""
    dut.bus__cyc.value = dut.bus__stb.value = 1
    dut.bus__we.value, dut.bus__sel.value = 0, 0xf
    clocks, data = 1, []
    for word in range(8):
        dut.bus__adr.value, dut.bus__cti.value = (address >> 2) + word, END if word == 7 else INCREMENT
        while not dut.bus__ack.value:
            await FallingEdge(dut.clk)
            clocks += 1
        data.append(dut.bus__dat_r.value.to_unsigned())
        await FallingEdge(dut.clk)
        clocks += 1
    return clocks - 1, data


async def release(dut, prefix="bus"):
    getattr(dut, f"{prefix}__cyc").value = getattr(dut, f"{prefix}__stb").value = 0
    await FallingEdge(dut.clk)


class Scratch(wiring.Component):
    """Two registers with a gap between them, behind the bridge."""

    class Word(Register, access="rw"):
        """A word."""
        value: Field(action.RW, 32, doc="Whatever was written.")

    def __init__(self):
        self._bank = RegisterBank(addr_width=2)
        for n in (0, 2):
            self._bank.add(self.Word, offset=4 * n, name=f"word{n}")
        self._bank.finish()
        self._decoder = csr.Decoder(addr_width=4, data_width=32)
        self._decoder.add(self._bank.bus, name="scratch", addr=4)
        self._bridge = RegisterBridge(self._decoder.bus)
        super().__init__({"bus": In(wishbone.Signature(addr_width=4, data_width=32, granularity=8,
                                                       features={"err"}))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.bank, m.submodules.decoder, m.submodules.bridge = self._bank, self._decoder, self._bridge
        connect(m, self._bridge.csr, self._decoder.bus)
        connect(m, flipped(self.bus), self._bridge.bus)
        return m


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def bridge_takes_two_clocks_an_access(dut):
    await start(dut)
    # Back to back, without a gap between them.
    assert await access(dut, 0x10, write=0x12345678) == (2, "ack", 0)
    assert await access(dut, 0x18, write=0x9abcdef0) == (2, "ack", 0)
    assert await access(dut, 0x10) == (2, "ack", 0x12345678)
    assert await access(dut, 0x18) == (2, "ack", 0x9abcdef0)
    await release(dut)
    for _ in range(5):
        assert dut.bus__ack.value == 0 and dut.bus__err.value == 0
        await FallingEdge(dut.clk)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def bridge_refuses_less_than_a_word_and_what_is_not_there(dut):
    await start(dut)
    await access(dut, 0x10, write=0x12345678)
    for select in range(15):
        assert (await access(dut, 0x10, write=0xffffffff, select=select))[:2] == (2, "err")
        assert (await access(dut, 0x10, select=select)) == (2, "err", 0)
    for address in (0x00, 0x0c, 0x14, 0x1c, 0x20, 0x3c):
        assert (await access(dut, address, write=0xffffffff))[:2] == (2, "err")
        assert await access(dut, address) == (2, "err", 0)
    assert await access(dut, 0x10) == (2, "ack", 0x12345678)


def test_bridge(simulate):
    simulate(Scratch(), tests="bridge")


PATIENCE = 16


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def timeout_ends_an_access_that_nobody_answers(dut):
    await start(dut, "initiator")
    dut.target__ack.value = dut.target__err.value = 0
    for address in (0x1000, 0x2000):                # again at once, with its full patience
        clocks, how, _ = await access(dut, address, prefix="initiator")
        assert (clocks, how) == (PATIENCE + 1, "err")
    await release(dut, "initiator")
    assert dut.initiator__err.value == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def timeout_lets_an_answer_through_untouched(dut):
    await start(dut, "initiator")

    async def answer(after, how):
        await ClockCycles(dut.clk, after)
        assert dut.target__stb.value == 1 and dut.target__adr.value == 0x1000 >> 2
        getattr(dut, f"target__{how}").value = 1
        dut.target__dat_r.value = 0xcafe0000 + after
        await RisingEdge(dut.clk)
        getattr(dut, f"target__{how}").value = 0

    for after in range(1, PATIENCE):
        for how in ("ack", "err"):
            dut.target__ack.value = dut.target__err.value = 0
            cocotb.start_soon(answer(after, how))
            assert await access(dut, 0x1000, prefix="initiator") == (after + 1, how, 0xcafe0000 + after)
            await release(dut, "initiator")
    assert dut.target__stb.value == 0


def test_timeout(simulate):
    simulate(BusTimeout(BUS, clocks=PATIENCE), tests="timeout")


def test_no_patience_is_refused():
    with pytest.raises(ValueError, match="at least 2, not 1"):
        BusTimeout(BUS, clocks=1)


REGIONS = [Region("rom", plusarg="rom", address=0, size=0x2000, writable=False),
           Region("ram", plusarg="ram", address=0x10000, size=0x20000, writable=True)]


def contents(region, address):
    return (0x0a000000 if region == "rom" else 0x0b000000) + address


async def arrays(dut, log):
    """Answer as block RAM does: what is addressed in a clock appears in the next.  Notes every access."""
    while True:
        await RisingEdge(dut.clk)
        address = dut.address.value.to_unsigned() << 2
        for region in "rom", "ram":
            if getattr(dut, f"{region}_enable").value:
                log.append((region, address, dut.write.value.to_unsigned()))
                getattr(dut, f"{region}_data").value = contents(region, address)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def port_takes_two_clocks_and_nine_for_a_line(dut):
    await start(dut)
    log = []
    cocotb.start_soon(arrays(dut, log))
    for region, addresses in (("rom", (0x0, 0x1ffc)), ("ram", (0x10000, 0x1fffc, 0x20000, 0x2fffc))):
        for address in addresses:
            assert await access(dut, address, cycle_type=CLASSIC) == (2, "ack", contents(region, address))
            await release(dut)
    for region, line in (("rom", 0x1fe0), ("ram", 0x10000), ("ram", 0x1ffe0), ("ram", 0x2ffe0)):
        log.clear()
        assert await line_fill(dut, line) == (9, [contents(region, line + 4 * word) for word in range(8)])
        await release(dut)
        assert log == [(region, line + 4 * word, 0) for word in range(8)]       # each word fetched once


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def port_refuses_what_is_not_there_and_writes_to_rom(dut):
    await start(dut)
    log = []
    cocotb.start_soon(arrays(dut, log))
    for address in (0x2000, 0xfffc, 0x30000, 0x3fffc):
        assert (await access(dut, address, cycle_type=CLASSIC))[:2] == (2, "err")
        await release(dut)
    assert (await access(dut, 0x100, write=1, cycle_type=CLASSIC))[:2] == (2, "err")
    await release(dut)
    assert log == []
    assert (await access(dut, 0x10100, write=1, select=0b0100, cycle_type=CLASSIC))[:2] == (2, "ack")
    await release(dut)
    assert log == [("ram", 0x10100, 0b0100)]


def test_port(simulate):
    simulate(BusPort(REGIONS, wishbone.Signature(addr_width=16, data_width=32, granularity=8,
                                                 features={"err", "cti", "bte"})), tests="port")


@pytest.mark.parametrize("address, size", [(0, 0x3000), (0x800, 0x2000)])
def test_a_region_that_cannot_be_decoded_is_refused(address, size):
    with pytest.raises(ValueError, match="power of two"):
        Region("odd", plusarg="odd", address=address, size=size, writable=True)
