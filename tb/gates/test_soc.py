# SPDX-License-Identifier: BSD-2-Clause
"""The product on its netlist, all of it: it comes out of reset and answers on the serial pin, and drives nothing before.

``make test-gates-soc``.  Only pins are driven and looked at; what is expected is the serial language's.
"""

import os
import sys

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, SimTimeoutError, Timer, ValueChange, with_timeout
from cocotb.utils import get_sim_time

from soc import gateware
from soc.ecp5 import ClockGenerator
from tb import verilated
from tb.gates.product import Product

pytestmark = [pytest.mark.gates, pytest.mark.skipif("GATES_SOC" not in os.environ, reason="make test-gates-soc")]

OSCILLATOR_PS = 40_000
BIT_PS = round(10**12 / 115_200)
START_MS = 4                    # from the end of reset to power stages on: the servo runs
ANSWER_MS = 20                  # to an answer; before the first one the settings are computed
STILL = ("enc_a", "enc_b", "enc_z", "limit_lower", "limit_upper", "estop", "in0", "in1", "button", "joystick_button",
         "dip", "knob_a", "knob_b", "adc_miso", "analog")
MOVES = "pwm", "motor_enable"

DIALOGUE = ((b"V\r", b":A Version: USB-9.2k \r\n"), (b"W X Y\r", b":A 0.0 0.0 \r\n"), (b"/\r", b"N\r\n"))

MUTABLE = r"^\\controller\.cpu\.core\.IBusCachedPlugin_fetchPc_booted"
"""A LUT of the processor's first fetch."""


class Board:
    """What hangs on the pins: oscillator, reset button, nothing that moves, and the host."""

    def __init__(self, dut):
        self.dut, self.driven = dut, []

    async def power_up(self):
        """All is as after configuration; returns at the end of reset."""
        dut = self.dut
        for name in STILL:
            getattr(dut, name).value = 0
        dut.serial_rx.value, dut.reset_button_n.value = 1, 1
        for name in MOVES:
            cocotb.start_soon(self._watch(name))
        Clock(dut.clk25, OSCILLATOR_PS, unit="ps").start()
        await Timer(1, unit="ps")
        await self.start()

    async def start(self):
        """Until reset ends, which LED 0 shows."""
        while not self.running:
            await with_timeout(ValueChange(self.dut.led), 1, "ms")

    @property
    def running(self):
        return int(self.dut.led.value) & 1

    async def _watch(self, name):
        """Keep when a pin that moves something was not 0."""
        pin = getattr(self.dut, name)
        while True:
            if int(pin.value):
                self.driven.append((name, get_sim_time("ps")))
            await ValueChange(pin)

    async def ask(self, request):
        """Send bytes; return what is answered, up to LF, or up to a pause of ``ANSWER_MS``."""
        answer = cocotb.start_soon(self._receive())
        for byte in request:
            for bit in (0, *(byte >> n & 1 for n in range(8)), 1):
                self.dut.serial_rx.value = bit
                await Timer(BIT_PS, unit="ps")
        return await answer

    async def _receive(self):
        received, pin = bytearray(), self.dut.serial_tx
        while not received.endswith(b"\n"):
            try:
                await with_timeout(pin.falling_edge, ANSWER_MS, "ms")
            except SimTimeoutError:
                break
            await Timer(BIT_PS * 3 // 2, unit="ps")
            bits = []
            for _ in range(9):
                bits.append(int(pin.value))
                if len(bits) < 9:
                    await Timer(BIT_PS, unit="ps")
            assert bits[8], "no stop bit"
            received.append(sum(bit << n for n, bit in enumerate(bits[:8])))
        return bytes(received)


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def answers_after_reset_and_drives_nothing_before(dut):
    board = Board(dut)
    await board.power_up()
    assert not board.driven, "driven before reset has ended"
    assert get_sim_time("ps") >= 1000 * ClockGenerator.HOLD_NS, "no reset"
    await with_timeout(dut.motor_enable.rising_edge, START_MS, "ms")
    for request, answer in DIALOGUE:
        assert await board.ask(request) == answer
    dut._log.info(f"answered by {get_sim_time('ms'):.3f} ms")
    # The reset button takes the drive off within clocks of the oscillator.
    assert int(dut.motor_enable.value) == 1
    dut.reset_button_n.value = 0
    await ClockCycles(dut.clk25, 4)
    assert not board.running and not int(dut.motor_enable.value) and not int(dut.pwm.value)
    board.driven.clear()
    dut.reset_button_n.value = 1
    await board.start()
    assert not board.driven, "driven in reset"


@pytest.fixture(scope="module")
def answers():
    """``answers(*plusargs, words=...)``: whether the netlist does, by default with the firmware."""
    product = Product("ulx3s-85f", mutable=MUTABLE)
    directory = product.simulation()
    firmware, sentence, whole = gateware.firmware_words(product.board.regions())
    assert whole, sentence

    def run(*plusargs, words=firmware):
        memory = product.memory(words)
        return not verilated.failures(directory, sys.modules[__name__], label="soc",
                                      plusargs=[f"+bram={memory}", *plusargs])
    run.firmware = firmware
    return run


def test_the_product_answers(answers):
    assert answers()


def test_a_wrong_lut_of_the_processor_is_noticed(answers):
    assert not answers("+mutant=0", "+entries=ffff")


def test_a_wrong_bit_of_the_boot_program_is_noticed(answers):
    """Which makes its first word no instruction."""
    first, *others = answers.firmware["boot"]
    assert not answers(words=answers.firmware | {"boot": [first ^ 2, *others]})
