# SPDX-License-Identifier: BSD-2-Clause
"""rtl/identity.py: constants read back as they were given, and nothing else is there."""

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

from rtl.identity import MAP_VERSION, IdentityPeripheral
from tb.rtl.register_bus import idle, read, write

EXPECTED = [0x41626265, MAP_VERSION, 0xfedcba98, 50_000_000, 200_000_000]
ARGUMENTS = {"build_id": 0xfedcba98, "clock_hz": 50_000_000, "fast_clock_hz": 200_000_000}


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def says_who_it_is_and_takes_no_other_name(dut):
    cocotb.start_soon(Clock(dut.clk, 20, unit="ns").start())
    idle(dut)
    dut.rst.value = 0
    await FallingEdge(dut.clk)
    for n, value in enumerate(EXPECTED):
        assert await read(dut, 4 * n) == value
        await write(dut, 4 * n, ~value & 0xffffffff)
        assert await read(dut, 4 * n) == value


def test_identity(simulate):
    simulate(IdentityPeripheral(**ARGUMENTS))


@pytest.mark.parametrize("build_id", [-1, 1 << 32])
def test_a_number_that_does_not_fit_is_refused(build_id):
    with pytest.raises(ValueError, match="BuildId must fit 32 bits"):
        IdentityPeripheral(**{**ARGUMENTS, "build_id": build_id})
