# SPDX-License-Identifier: BSD-2-Clause
"""Read and write the registers of a peripheral under test through its ``bus``, at falling edges of ``clk``."""

from cocotb.triggers import FallingEdge


def idle(dut):
    for pin in dut.bus__addr, dut.bus__r_stb, dut.bus__w_stb, dut.bus__w_data:
        pin.value = 0


async def write(dut, offset, value):
    """Takes one clock: the strobe is taken by the edge in it."""
    dut.bus__addr.value, dut.bus__w_data.value, dut.bus__w_stb.value = offset // 4, value & 0xffffffff, 1
    await FallingEdge(dut.clk)
    dut.bus__w_stb.value = 0


async def read(dut, offset, *, signed=False):
    """Takes one clock; the data of the clock after the strobe."""
    dut.bus__addr.value, dut.bus__r_stb.value = offset // 4, 1
    await FallingEdge(dut.clk)
    dut.bus__r_stb.value = 0
    value = dut.bus__r_data.value
    return value.to_signed() if signed else value.to_unsigned()
