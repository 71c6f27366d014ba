# SPDX-License-Identifier: BSD-2-Clause
"""A trigger freezes the position of all axes: no matter how they are filtered, as of one sample of the pins."""

from amaranth import Array, Cat, Module, Signal, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from rtl.quadrature import FILTER_BITS

__all__ = ["MINIMUM", "MINIMUM_BITS", "TriggerCapture", "TriggerSettings"]

MINIMUM_BITS = 8

MINIMUM = 2 + (1 << FILTER_BITS)
"""Shortest pulse in ``fast`` clocks: by then the axis with the longest filter has shown where it was at the trigger."""


TriggerSettings = data.StructLayout({"minimum": MINIMUM_BITS, "enable": 1})
"""``minimum``: clocks that a pulse must last, and the pause after it; at least :data:`MINIMUM`."""


class TriggerCapture(wiring.Component):
    """Latch the counts of all axes as they were when the trigger rose, and say so once it has proven a pulse.

    Domain ``fast``.  ``level`` and the encoders' pins pass like synchronisers.  A count is taken as many clocks later
    as its axis needs to show the sample in which the level rose: 2, and its filter's.  So all counts of a record are
    those of that one sample, whatever the filters, and none of them waits for ``minimum``.

    A rise that does not last for ``minimum`` clocks is a glitch: no record, no pause.  After a pulse the level must be
    low for ``minimum`` clocks without a break before the next rise is one.

    Parameters
    ----------
    axes, width : int
        Number of counts, and bits of each.

    Members
    -------
    level : In(1)
        The pin, behind a synchroniser of two flip-flops.
    settings : In(TriggerSettings)
        ``minimum`` is taken as a pulse or a pause begins.  Disabled, no pulse begins.
    ready : In(1)
        0 while a record can not be taken.  Looked at as a pulse begins; it must not fall before its record.
    filter : In(4).array(axes)
        That the decoders use.
    count : In(signed(width)).array(axes)
        Of the decoders.
    time : In(64)
    record : Out(1)
        One-clock strobe, in the clock after the pulse's clock number ``minimum``: ``counts`` and ``moment`` are those
        of a pulse, until a rise while ``ready``.
    counts : Out(signed(width)).array(axes)
    moment : Out(64)
        ``time`` in the clock after the first that shows the level: 3 more than in the clock whose end sampled the pin.
    missed : Out(1)
        One-clock strobe: the level rose while not ``ready``; this pulse has no record.
    """

    def __init__(self, *, axes=4, width=32):
        self._axes = axes
        # State, for proofs.  ``was``: the level a clock ago.  ``idle``: a rise begins a pulse.  ``pulse``: it has to
        # last for ``left`` more clocks.  Neither: a pause has to.
        self._was, self._idle, self._pulse = Signal(init=1), Signal(), Signal()
        self._left = Signal(MINIMUM_BITS, init=MINIMUM)
        super().__init__({
            "level": In(1), "settings": In(TriggerSettings), "ready": In(1), "filter": In(FILTER_BITS).array(axes),
            "count": In(signed(width)).array(axes), "time": In(64),
            "record": Out(1), "counts": Out(signed(width)).array(axes), "moment": Out(64), "missed": Out(1),
        })

    def elaborate(self, platform):
        m = Module()
        idle, pulse, left, minimum = self._idle, self._pulse, self._left, self.settings.minimum
        m.d.fast += [self._was.eq(self.level), self.record.eq(0), self.missed.eq(0)]
        rise, begin = Signal(), Signal()
        m.d.comb += [rise.eq(idle & self.level & ~self._was & self.settings.enable), begin.eq(rise & self.ready)]

        last = Signal()
        m.d.comb += last.eq(left == 1)
        with m.If(pulse):
            m.d.fast += [left.eq(left - 1), pulse.eq(self.level & ~last)]
            with m.If(~self.level):
                m.d.fast += idle.eq(1)
            with m.Elif(last):
                m.d.fast += [self.record.eq(1), left.eq(minimum)]
        with m.Elif(rise):
            m.d.fast += [idle.eq(0), pulse.eq(self.ready), left.eq(minimum - self.ready), self.missed.eq(~self.ready)]
        with m.Elif(~idle):
            m.d.fast += [left.eq(left - 1), idle.eq(~self.level & last)]
            with m.If(self.level):
                m.d.fast += left.eq(minimum)

        # A glitch's strobes are still on their way as the next pulse begins; those of the pulse come last.
        age = Signal(1 << FILTER_BITS)              # bit k: a pulse began k + 1 clocks ago
        m.d.fast += age.eq(Cat(begin, age))
        with m.If(age[0]):
            m.d.fast += self.moment.eq(self.time)
        for n in range(self._axes):
            take = Signal(name=f"take{n}")
            m.d.fast += take.eq(Array(age)[self.filter[n]])
            with m.If(take):
                m.d.fast += self.counts[n].eq(self.count[n])
        return m
