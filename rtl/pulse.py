# SPDX-License-Identifier: BSD-2-Clause
"""Pulses of a programmable length."""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from rtl.countdown import Countdown

__all__ = ["Pulse"]


class Pulse(wiring.Component):
    """A pulse of ``width`` clocks for each trigger.

    Domain ``fast``.  ``pulse`` rises one clock after ``trigger`` and is high for exactly ``width`` clocks.  A
    trigger while it is high begins the length anew without a gap, and is counted as merged; the first trigger
    that makes a pulse of its own is ``width + 1`` clocks after the last.

    Parameters
    ----------
    width : int
        Bits of ``width``, more than 8; otherwise :exc:`ValueError`.

    Members
    -------
    trigger : In(1)
        Strobe.
    width : In(width)
        Length in clocks, at least 1.  Taken with a trigger, as it was in the clock before.
    clear : In(1)
        Strobe: ``merged`` to 0.  Wins over a trigger in the same clock.
    pulse : Out(1)
        From a flip-flop; 0 at reset.
    merged : Out(32)
        Triggers that came while ``pulse`` was high, since the last ``clear``.  Wraps.
    """

    def __init__(self, *, width):
        self._countdown = Countdown(width=width)
        super().__init__({"trigger": In(1), "width": In(width), "clear": In(1),
                          "pulse": Out(1), "merged": Out(32)})

    def elaborate(self, platform):
        m = Module()
        m.submodules.countdown = countdown = self._countdown
        m.d.comb += [
            countdown.value.eq(self.width), countdown.load.eq(self.trigger), countdown.step.eq(self.pulse),
        ]
        m.d.fast += self.pulse.eq(self.trigger | (self.pulse & ~countdown.last))
        with m.If(self.clear):
            m.d.fast += self.merged.eq(0)
        with m.Elif(self.trigger & self.pulse):
            m.d.fast += self.merged.eq(self.merged + 1)
        return m
