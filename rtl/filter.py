# SPDX-License-Identifier: BSD-2-Clause
"""A glitch filter for a level of ``fast``: what does not last is not believed."""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["GlitchFilter"]


class GlitchFilter(wiring.Component):
    """Take a level only after it has stayed for ``samples`` further samples.

    Domain ``fast``.  ``level`` follows ``i`` one clock later when ``samples`` is 0; otherwise it takes a new
    level once ``samples + 1`` samples in a row showed it, so exactly ``samples`` clocks later than without
    filter, and pulses of at most ``samples`` samples vanish.  Longer ones keep their length.

    Parameters
    ----------
    bits : int
        Of ``samples``, at least 1; otherwise :exc:`ValueError`.

    Members
    -------
    i : In(1)
        Synchronised input.
    samples : In(bits)
        Taken while the level stands still.
    off : In(1)
        ``samples`` is 0.
    load : In(1)
        The next sample is taken at once, whatever ``samples`` is.
    still : Out(1)
        No change of level is on its way.
    change : Out(1)
        ``level`` changes at the end of this clock.
    next : Out(1)
        What ``level`` is then.
    level : Out(1)
        Filtered level; 0 at reset.
    """

    def __init__(self, *, bits):
        if not isinstance(bits, int) or bits < 1:
            raise ValueError(f"a filter's setting has at least 1 bit, not {bits!r}")
        # State, for proofs.  ``missing``: further samples that must differ from ``level`` before the one that is
        # believed.  ``ready``: none is missing, or the level is being loaded.
        self._missing, self._ready = Signal(bits), Signal(init=1)
        super().__init__({"i": In(1), "samples": In(bits), "off": In(1), "load": In(1),
                          "still": Out(1), "change": Out(1), "next": Out(1), "level": Out(1)})

    def elaborate(self, platform):
        m = Module()
        missing, ready = self._missing, self._ready
        m.d.comb += [
            self.still.eq(self.i == self.level), self.change.eq(ready & ~self.still),
            self.next.eq(Mux(ready, self.i, self.level)),
        ]
        with m.If(~self.still & ~ready):
            m.d.fast += [missing.eq(missing - 1), ready.eq((missing == 1) | self.load)]
        with m.Else():
            m.d.fast += [missing.eq(self.samples), ready.eq(self.off | self.load)]
        m.d.fast += self.level.eq(self.next)
        return m
