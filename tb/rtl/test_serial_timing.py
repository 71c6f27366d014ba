# SPDX-License-Identifier: BSD-2-Clause
"""rtl/serial.py: how soon a byte is there, and how soon one leaves."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

from rtl.serial import SerialPeripheral
from tb.rtl.register_bus import idle, write

DATA, DIVISOR, ENABLE = 0x00, 0x10, 0x14
ENABLE_RX = 1


async def start(dut, divisor):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rx.value, dut.rst.value = 1, 1
    await ClockCycles(dut.clk, 2, FallingEdge)
    dut.rst.value = 0
    await write(dut, DIVISOR, divisor)
    await write(dut, ENABLE, ENABLE_RX)
    await ClockCycles(dut.clk, 2 * divisor + 20, FallingEdge)


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(divisor=[8, 16, 434], byte=[0x00, 0x55, 0xff])
async def a_byte_is_there_in_the_middle_of_its_stop_bit(dut, divisor, byte):
    await start(dut, divisor)
    for bit in [0, *(byte >> n & 1 for n in range(8))]:
        dut.rx.value = bit
        for _ in range(divisor):
            assert dut.interrupt.value == 0
            await FallingEdge(dut.clk)
    dut.rx.value = 1
    clocks = 0
    while not dut.interrupt.value:
        await FallingEdge(dut.clk)
        clocks += 1
    # The middle, and the way through synchroniser, receiver and FIFO.
    assert divisor // 2 <= clocks <= divisor // 2 + 8


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(divisor=[8, 434])
async def a_start_bit_leaves_an_idle_line_one_bit_after_the_write(dut, divisor):
    await start(dut, divisor)
    for _ in range(3):
        await write(dut, DATA, 0x55)            # as the bridge writes, the second of its 2 clocks follows
        clocks = 1
        while dut.tx.value:
            await FallingEdge(dut.clk)
            clocks += 1
        dut._log.info("start bit %d clocks after the strobe", clocks)
        assert clocks == divisor + 4
        await ClockCycles(dut.clk, 13 * divisor, FallingEdge)


def test_in_time(simulate):
    simulate(SerialPeripheral())
