# SPDX-License-Identifier: BSD-2-Clause
"""The ULX3S, with either size of FPGA."""

from amaranth import Cat
from amaranth.lib.wiring import In, Out

from soc.ecp5 import Board

__all__ = ["BOARDS"]


class Ulx3s(Board):
    """Members of the board itself
    ---------------------------
    reset_button_n : In(1)
        Button PWR, 0 = pressed: reset.
    led : Out(8)
        0 running, 1 power stages on, 2 emergency stop, 3 a limit reached, 4 and 5 serial bytes from and to the
        host; 6 and 7 dark.
    analog : In(6)
        Pins that are wired to inputs of the ADC; members so that the FPGA does not pull at them.
    wifi_en, wifi_en_v31 : Out(1)
        The board's ESP32 stays in reset: it shares pins with the FPGA.
    """

    package, speed = "CABGA381", "6"
    oscillator = "clk25", 25_000_000
    programmer = "ulx3s"
    ecppack = "--freq", "38.8"          # MHz of the clock that reads the flash, which allows 50 for plain reads
    PINS = {"reset_button_n": In(1), "led": Out(8), "analog": In(6), "wifi_en": Out(1), "wifi_en_v31": Out(1)}

    def system(self, m, clocks):
        m.d.comb += [
            clocks.request.eq(~self.reset_button_n),
            self.led.eq(Cat(~clocks.safe, self.motor_enable, self.estop, self.limit_lower.any() | self.limit_upper.any(),
                            ~self.serial_rx, ~self.serial_tx)),
        ]


class Ulx3s85F(Ulx3s):
    """The product."""
    name, device = "ulx3s-85f", "LFE5U-85F"


class Ulx3s25F(Ulx3s):
    """A check of area and timing: beside caches and queues its 56 EBR hold 16 KiB of RAM, too little for the firmware."""
    name, device = "ulx3s-25f", "LFE5U-25F"
    ram_bytes = 16 << 10


BOARDS = (Ulx3s85F, Ulx3s25F)
