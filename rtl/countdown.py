# SPDX-License-Identifier: BSD-2-Clause
"""A loadable counter that announces its last step, at one step or one load per clock."""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Countdown"]

LOW_BITS = 8


class Countdown(wiring.Component):
    """Count ``value`` steps; ``last`` says that the next one is the last.

    Domain ``fast``.  ``last`` comes from a flip-flop and is true to every step and load up to the clock before,
    so a user can load again in the very clock of the last step, down to a value of 1 in every clock.

    Only the low byte is compared in the clock it changes in.  Whether the rest is zero is registered one clock
    late: it can only have become so when the low byte went from 0 to 255, and is not asked before the low byte
    is back at 2.

    Parameters
    ----------
    width : int
        Bits of the count, more than 8; otherwise :exc:`ValueError`.

    Members
    -------
    value : In(width)
        Steps to count, at least 1 (0 counts as 2**width).  A load takes ``value`` of the clock before.
    load : In(1)
        Strobe: begin again.  Wins over ``step``.
    step : In(1)
        Strobe: one step done.  After the last step the next must be a load.
    last : Out(1)
        One step is left.  0 at reset.
    """

    def __init__(self, *, width):
        if not isinstance(width, int) or width <= LOW_BITS:
            raise ValueError(f"a countdown needs more than {LOW_BITS} bits, not {width!r}")
        self._width = width
        super().__init__({"value": In(width), "load": In(1), "step": In(1), "last": Out(1)})

    def elaborate(self, platform):
        m = Module()
        start = Signal(self._width)
        start_last, start_short = Signal(), Signal()
        m.d.fast += [
            start.eq(self.value),
            start_last.eq(self.value == 1),
            start_short.eq(self.value[LOW_BITS:] == 0),
        ]

        low = Signal(LOW_BITS)
        high = Signal(self._width - LOW_BITS)
        short = Signal()                            # ``high`` was 0 one clock ago, or at the load
        m.d.fast += short.eq(high == 0)
        with m.If(self.load):
            m.d.fast += [low.eq(start), high.eq(start[LOW_BITS:]), self.last.eq(start_last),
                         short.eq(start_short)]
        with m.Elif(self.step):
            m.d.fast += [low.eq(low - 1), self.last.eq(short & (low == 2))]
            with m.If(low == 0):
                m.d.fast += high.eq(high - 1)
        return m
