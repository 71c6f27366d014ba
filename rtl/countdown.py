# SPDX-License-Identifier: BSD-2-Clause
"""A loadable counter that announces its last step, at one step or one load per clock."""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Countdown"]

LOW_BITS = 8


class Countdown(wiring.Component):
    """Count ``value`` steps, or one more; ``last`` says that the next one is the last.

    Domain ``fast``.  ``last`` comes from a flip-flop and is true to every step and load up to the clock before,
    so a user can load again in the very clock of the last step, down to a value of 1 in every clock.

    Only the low byte is compared in the clock it changes in.  The rest follows it by a clock and is compared a
    clock after that: it can only have become zero when the low byte went from 0 to 255, and is not asked before
    the low byte is back at 2.

    Parameters
    ----------
    width : int
        Bits of the count, more than 8; otherwise :exc:`ValueError`.

    Members
    -------
    value : In(width)
        Steps to count, at least 1 (0 counts as 2**width).  A load takes ``value`` of the clock before.
    extra : In(1)
        With ``load``: count one step more.
    load : In(1)
        Strobe: begin again.  Wins over ``step``.
    step : In(1)
        Strobe: one step done.  After the last, without a load, 2**width more follow.
    last : Out(1)
        One step is left.  0 at reset.
    """

    def __init__(self, *, width):
        if not isinstance(width, int) or width <= LOW_BITS:
            raise ValueError(f"a countdown needs more than {LOW_BITS} bits, not {width!r}")
        self._width = width
        super().__init__({"value": In(width), "extra": In(1), "load": In(1), "step": In(1), "last": Out(1)})

    def elaborate(self, platform):
        m = Module()
        start = Signal(self._width)
        start_one, start_short = Signal(), Signal()
        m.d.fast += [
            start.eq(self.value),
            start_one.eq(self.value == 1),
            start_short.eq(self.value[LOW_BITS:] == 0),
        ]

        # ``one``: the count is 1.  ``more``: after it comes the extra step.
        low, high = Signal(LOW_BITS), Signal(self._width - LOW_BITS)
        one, more = Signal(), Signal()
        borrow = Signal()                           # ``high`` is one too many
        short = Signal()                            # ``high`` was 0 one clock ago, or at the load
        two = short & (low == 2)
        m.d.fast += [
            short.eq(Mux(self.load, start_short, high == 0)),
            borrow.eq(self.step & ~self.load & (low == 0)),
            more.eq(Mux(self.load, self.extra, more & ~(self.step & one))),
        ]
        with m.If(self.load):
            m.d.fast += [low.eq(start), one.eq(start_one), self.last.eq(start_one & ~self.extra)]
        with m.Elif(self.step):
            m.d.fast += [low.eq(low - ~(one & more)), one.eq(two | (one & more)),
                         self.last.eq((one & more) | (two & ~more))]
        with m.If(self.load):
            m.d.fast += high.eq(start[LOW_BITS:])
        with m.Elif(borrow):
            m.d.fast += high.eq(high - 1)
        return m
