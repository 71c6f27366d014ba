# SPDX-License-Identifier: BSD-2-Clause
"""A level that ignores what does not last: for contacts that bounce and wires that pick up noise."""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Debounce"]


class Debounce(wiring.Component):
    """Follow a level once it has lasted.  Domain ``sync``.

    ``o`` becomes ``i`` on the ``periods``-th strobe in a row, without a clock between them on which ``i`` was
    ``o``: a new level shows 1 clock after that strobe, ``periods`` - 1 to ``periods`` strobe intervals after the
    last bounce, and anything shorter never.  0 and 1 are the same, the next strobe at which they differ.

    Parameters
    ----------
    width : int
        Bits of ``periods``.

    Members
    -------
    i : In(1)
        Level, of this domain already.
    strobe : In(1)
        Time base.
    periods : In(width)
        Strobes a level must last.  A smaller number acts at once.
    o : Out(1)
        Low after reset.
    """

    def __init__(self, *, width):
        if not isinstance(width, int) or width < 1:
            raise ValueError(f"width must be an integer of at least 1, not {width!r}")
        self._seen = Signal(width)              # strobes that the new level has lasted
        super().__init__({"i": In(1), "strobe": In(1), "periods": In(width), "o": Out(1)})

    def elaborate(self, platform):
        m = Module()
        seen = self._seen
        with m.If(self.i == self.o):
            m.d.sync += seen.eq(0)
        with m.Elif(self.strobe):
            m.d.sync += seen.eq(seen + 1)
            with m.If(seen + 1 >= self.periods):
                m.d.sync += [self.o.eq(self.i), seen.eq(0)]
        return m
