# SPDX-License-Identifier: BSD-2-Clause
"""rtl/registers.py: a bank is read and written over its bus as its classes say."""

import cocotb
import pytest
from amaranth import Module, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge

from rtl.registers import Field, Register, RegisterBank, action, snake_case


class Sample(wiring.Component):
    """A block with one register of each access."""

    class Setting(Register, access="rw"):
        """Two settings."""
        low: Field(action.RW, 5, init=9, doc="A number.")
        high: Field(action.RW, signed(9), doc="A signed number.")

    class Input(Register, access="r"):
        """An input."""
        value: Field(action.R, 32, doc="The pins.")

    class Event(Register, access="rw"):
        """Events."""
        first: Field(action.RW1C, 1, doc="Set by hardware.")
        second: Field(action.RW1C, 1, doc="Set by hardware.")

    def __init__(self):
        self._registers = RegisterBank(addr_width=3)
        self._setting = self._registers.add(self.Setting, offset=0x00)
        self._input = self._registers.add(self.Input, offset=0x08)
        self._event = self._registers.add(self.Event, offset=0x0c)
        memory_map = self._registers.finish()
        super().__init__({"bus": In(self._registers.bus_signature), "value": In(32), "set": In(2),
                          "low": Out(5), "high": Out(signed(9))})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        m.d.comb += [
            self._input.f.value.r_data.eq(self.value),
            self._event.f.first.set.eq(self.set[0]), self._event.f.second.set.eq(self.set[1]),
            self.low.eq(self._setting.f.low.data), self.high.eq(self._setting.f.high.data),
        ]
        return m


async def start(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    for pin in (dut.rst, dut.bus__addr, dut.bus__r_stb, dut.bus__w_stb, dut.bus__w_data, dut.value, dut.set):
        pin.value = 0
    await RisingEdge(dut.clk)


async def read(dut, offset):
    dut.bus__addr.value, dut.bus__r_stb.value = offset // 4, 1
    await RisingEdge(dut.clk)
    dut.bus__r_stb.value = 0
    await RisingEdge(dut.clk)
    return dut.bus__r_data.value.to_unsigned()


async def write(dut, offset, value):
    dut.bus__addr.value, dut.bus__w_data.value, dut.bus__w_stb.value = offset // 4, value, 1
    await RisingEdge(dut.clk)
    dut.bus__w_stb.value = 0
    await RisingEdge(dut.clk)
    await RisingEdge(dut.clk)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def fields_lie_in_the_order_written(dut):
    await start(dut)
    assert await read(dut, 0) == 9
    await write(dut, 0, (0x1f3 << 5) | 17)
    assert dut.low.value.to_unsigned() == 17
    assert dut.high.value.to_signed() == 0x1f3 - 512
    assert await read(dut, 0) == (0x1f3 << 5) | 17


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def an_input_is_read_live(dut):
    await start(dut)
    dut.value.value = 0xdeadbeef
    assert await read(dut, 8) == 0xdeadbeef


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def an_event_stays_until_its_own_bit_is_written(dut):
    await start(dut)
    dut.set.value = 3
    await RisingEdge(dut.clk)
    dut.set.value = 0
    await RisingEdge(dut.clk)
    await write(dut, 0xc, 1)
    assert await read(dut, 0xc) == 2


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def an_event_in_the_clock_in_which_it_is_cleared_is_kept(dut):
    """The event comes in each of the clocks around the write: an earlier one is cleared, any other stays."""
    await start(dut)
    kept = []
    for clock in range(6):
        dut.set.value = 1
        await RisingEdge(dut.clk)
        dut.set.value = 0
        await RisingEdge(dut.clk)
        dut.bus__addr.value, dut.bus__w_data.value = 3, 1
        for n in range(8):
            dut.set.value, dut.bus__w_stb.value = int(n == clock), int(n == 2)
            await RisingEdge(dut.clk)
        kept.append(await read(dut, 0xc) & 1)
        await write(dut, 0xc, 3)
        assert await read(dut, 0xc) == 0
    # The strobe of clock 2 clears in clock 3.
    assert kept == [0, 0, 0, 1, 1, 1]


def test_bank_on_its_bus(simulate):
    simulate(Sample())


def test_names():
    assert [snake_case(n) for n in ("Width", "TickTimeLow", "Duty0")] == ["width", "tick_time_low", "duty0"]


def test_a_field_without_description_is_refused():
    with pytest.raises(ValueError, match="description"):
        Field(action.RW, 3, doc="")


def test_a_register_without_docstring_is_refused():
    with pytest.raises(ValueError, match="docstring"):
        class Bare(Register, access="r"):
            value: Field(action.R, 1, doc="x")


def test_a_register_of_more_than_32_bits_is_refused():
    class Wide(Register, access="r"):
        """Too wide."""
        a: Field(action.R, 32, doc="x")
        b: Field(action.R, 1, doc="x")
    with pytest.raises(ValueError, match="33 bits"):
        Wide()
