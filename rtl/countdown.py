# SPDX-License-Identifier: BSD-2-Clause
"""A loadable counter that announces its last step, at one step or one load per clock."""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Countdown"]

LOW_BITS = 8


class Countdown(wiring.Component):
    """Count ``value`` steps, or one more, once or over and over; ``last`` says that the next one is the last.

    Domain ``fast``; one step per clock.  ``last`` comes from a flip-flop and is true to every step and load up
    to the clock before, even when it is reloaded with 1 in every clock.

    Only the low byte is loaded and compared in the clock it changes in.  The rest is loaded a clock later, borrowed
    from two clocks later, so that nothing stands behind its carry chain, and compared a clock after that: it can only
    become zero when the low byte goes from 0 to 255, and is not asked before the low byte is back at 2.

    Parameters
    ----------
    width : int
        Bits of the count, more than 8; otherwise :exc:`ValueError`.

    Members
    -------
    value : In(width)
        Steps to count, at least 1.  A load takes ``value`` of the clock before; a reload needs it still.
    load : In(1)
        Strobe: begin.  Wins over ``step``.
    reload : In(1)
        The last step begins anew.  Without it the next ``last`` is at least 2**width - 1 steps away.
    extra : In(1)
        With a load or reload: count one step more.
    step : In(1)
        Strobe: one step done.
    last : Out(1)
        One step is left.  0 at reset.
    """

    def __init__(self, *, width):
        if not isinstance(width, int) or width <= LOW_BITS:
            raise ValueError(f"a countdown needs more than {LOW_BITS} bits, not {width!r}")
        # State, for proofs.  ``one``: the count is 1.  ``more``: after it comes the extra step.  ``borrow``:
        # ``high`` is one too many.  ``due``: it still is, and ``less`` is what it will be.  ``began``: ``high`` is
        # still to be loaded.  ``short``: ``high`` was 0 one clock ago, or will be when it is loaded.
        self._start, self._start_one, self._start_short = Signal(width), Signal(), Signal(init=1)
        self._low, self._high = Signal(LOW_BITS), Signal(width - LOW_BITS)
        self._one, self._more, self._borrow = Signal(), Signal(), Signal()
        self._due, self._less = Signal(), Signal(width - LOW_BITS)
        self._began, self._short = Signal(), Signal()
        super().__init__({"value": In(width), "load": In(1), "reload": In(1), "extra": In(1), "step": In(1),
                          "last": Out(1)})

    def elaborate(self, platform):
        m = Module()
        start, start_one, start_short = self._start, self._start_one, self._start_short
        low, high, one, more = self._low, self._high, self._one, self._more
        borrow, due, less, began, short = self._borrow, self._due, self._less, self._began, self._short

        with m.If(~self.load):                      # the upper part is still to be taken
            m.d.fast += [
                start.eq(self.value),
                start_one.eq(self.value == 1),
                start_short.eq(self.value[LOW_BITS:] == 0),
            ]

        begin, again, stay, two = Signal(), Signal(), Signal(), Signal()
        m.d.comb += [
            again.eq(self.last & self.reload),
            begin.eq(self.load | (self.step & again)),
            stay.eq(one & more),
            two.eq(short & (low == 2)),
        ]
        # What follows a step depends on registers only; whether there is one comes late in the clock.
        with m.If(self.load):
            m.d.fast += [one.eq(start_one), more.eq(self.extra), self.last.eq(start_one & ~self.extra)]
        with m.Elif(self.step):
            m.d.fast += [
                one.eq(Mux(again, start_one, two | stay)),
                more.eq(Mux(again, self.extra, more & ~one)),
                self.last.eq(Mux(again, start_one & ~self.extra, Mux(more, one, two))),
            ]
        with m.If(begin):
            m.d.fast += low.eq(start)
        with m.Elif(self.step):
            m.d.fast += low.eq(low - 1)             # also to 0 before the extra step, where nobody looks

        m.d.fast += [
            began.eq(begin),
            short.eq(Mux(begin | began, start_short, high == 0)),
            borrow.eq(self.step & ~self.load & (low == 0)),
            due.eq(borrow & ~began), less.eq(high - 1),
        ]
        with m.If(began):
            m.d.fast += high.eq(start[LOW_BITS:])
        with m.Elif(due):
            m.d.fast += high.eq(less)
        return m
