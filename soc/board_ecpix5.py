# SPDX-License-Identifier: BSD-2-Clause
"""The ECPIX-5, with the larger size of FPGA."""

from amaranth import Cat, Const
from amaranth.lib.wiring import In, Out

from soc.ecp5 import Board

__all__ = ["BOARDS"]


class Ecpix585F(Board):
    """Members of the board itself
    ---------------------------
    reset_button_n : In(1)
        The board's only button, 0 = pressed: reset.
    led_red_n, led_green_n, led_blue_n : Out(4)
        The colours of LD5 to LD8, 0 = lit.  LD5: green running, red emergency stop.  LD6: green power stages on, red
        a limit reached.  LD7: green a byte to the host, blue one from it.  LD8 dark.

    It has no DIP switches: all off, which is the serial port at 115200 bit/s; DIP Y= says otherwise.
    """

    name, device, package, speed = "ecpix5-85f", "LFE5UM5G-85F", "CABGA554", "8"
    oscillator = "clk100", 100_000_000
    programmer = "ecpix5"
    PINS = {"reset_button_n": In(1), "led_red_n": Out(4), "led_green_n": Out(4), "led_blue_n": Out(4)}
    ABSENT = {"dip": 0}

    def system(self, m, clocks):
        limit = self.limit_lower.any() | self.limit_upper.any()
        dark = Const(0)
        m.d.comb += [
            clocks.request.eq(~self.reset_button_n),
            self.led_red_n.eq(~Cat(self.estop, limit, dark, dark)),
            self.led_green_n.eq(~Cat(~clocks.safe, self.motor_enable, ~self.serial_tx, dark)),
            self.led_blue_n.eq(~Cat(dark, dark, ~self.serial_rx, dark)),
        ]


BOARDS = (Ecpix585F,)
