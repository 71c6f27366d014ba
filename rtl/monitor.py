# SPDX-License-Identifier: BSD-2-Clause
"""What an encoder says of its axis, watched in ``sync``: the counts, and four ways in which they can be wrong."""

from amaranth import Cat, Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from rtl.crossing import Latch

__all__ = ["Budget", "CountSampler", "Following", "MEAN_WINDOWS", "Overspeed", "Progress", "ProgressLimits", "SAMPLE_CLOCKS",
           "STEP_BITS", "WINDOW_SAMPLES"]

SAMPLE_CLOCKS = 25
"""``sync`` clocks from one sample of the counts to the next: 0.5 us, in which a count changes by 100 at most."""

STEP_BITS = 8
"""Bits of a count that cross; a step from sample to sample fits, with a clock or two to spare."""

WINDOW_SAMPLES = 200
"""Samples of a window: 100 us."""

MEAN_BITS = 6
MEAN_WINDOWS = 1 << MEAN_BITS
"""Windows in which a mean drive follows: 6.4 ms, of which the pulse of a nudge is a small part."""


class CountSampler(wiring.Component):
    """The counts of all axes, carried from ``fast`` to ``sync`` every :data:`SAMPLE_CLOCKS`.

    Only their lowest bits cross; the whole counts are added up again from the steps, from 0 at reset as the decoders'.

    Parameters
    ----------
    axes : int

    Members
    -------
    low : In(STEP_BITS).array(axes), fast
        The lowest bits of the decoders' counts.
    stb : Out(1), sync
        One-clock strobe: a new sample, latched at most 7 clocks ago.
    steps : Out(signed(STEP_BITS)).array(axes), sync
        With ``stb``: how far each count went since the sample before.
    counts : Out(signed(32)).array(axes), sync
        The counts as of the last sample, from the clock after its ``stb``.
    window : Out(1), sync
        With every :data:`WINDOW_SAMPLES`-th ``stb``: it ends a window.
    """

    def __init__(self, *, axes):
        self._axes = axes
        self._latch = Latch(STEP_BITS * axes, source="fast", reader="sync")
        self._wait, self._sample = Signal(range(SAMPLE_CLOCKS)), Signal(range(WINDOW_SAMPLES))
        self._last = [Signal(STEP_BITS, name=f"last{n}") for n in range(axes)]
        super().__init__({
            "low": In(STEP_BITS).array(axes), "stb": Out(1), "steps": Out(signed(STEP_BITS)).array(axes),
            "counts": Out(signed(32)).array(axes), "window": Out(1),
        })

    def elaborate(self, platform):
        m = Module()
        m.submodules.latch = latch = self._latch
        again, full = self._wait == SAMPLE_CLOCKS - 1, self._sample == WINDOW_SAMPLES - 1
        m.d.sync += [self._wait.eq(Mux(again, 0, self._wait + 1)), self.stb.eq(latch.done)]
        m.d.comb += [
            latch.i.eq(Cat(*self.low)), latch.request.eq(again), self.window.eq(self.stb & full),
        ]
        for n, last in enumerate(self._last):
            now = latch.o.word_select(n, STEP_BITS)
            with m.If(latch.done):
                m.d.sync += [self.steps[n].eq((now - last)[:STEP_BITS]), last.eq(now)]
            with m.If(self.stb):
                m.d.sync += self.counts[n].eq(self.counts[n] + self.steps[n])
        with m.If(self.stb):
            m.d.sync += self._sample.eq(Mux(full, 0, self._sample + 1))
        return m


ProgressLimits = data.StructLayout({
    "way": unsigned(4), "strong": unsigned(12), "strong_samples": unsigned(16), "breakaway": unsigned(12),
    "held": unsigned(12), "samples": unsigned(16),
})
"""``way``: counts.  ``strong``, ``breakaway``, ``held``: magnitudes of drive.  The others: samples."""


class Progress(wiring.Component):
    """Driven, and no way made.  Domain ``sync``.

    *Way is made* when the counts since it was last made differ by ``limits.way`` or more: from the lowest to the
    highest, in either direction.  With A or B stuck a count goes to and fro between two neighbours, with both it stands.

    The *excess* is the drive or, of an axis that is to ``hold``, the drive less the mean drive at the sample at which way
    was last made: what holds a load that stands is no reason to move.  The mean follows the drive by a part in
    :data:`MEAN_WINDOWS` in each window.  ``fault`` is high, from the clock after a sample, when no way was made and the
    excess had one sign

    * in ``strong_samples`` + 1 samples in a row with a magnitude of at least ``strong``, unless it is to hold, or
    * in ``samples`` + 1 samples in a row with a magnitude of at least ``breakaway``, of an axis that holds: ``held``;

    and low again after a sample with way made, too small an excess, or one of the other sign.

    Members
    -------
    stb, window : In(1)
        A sample; with ``window`` it is the last of a window.
    step : In(signed(STEP_BITS))
        With ``stb``: counts since the one before.
    drive : In(signed(13))
        Present drive; taken a clock late.
    hold : In(1)
        See above.
    limits : In(ProgressLimits)
    fault : Out(1)
    """

    def __init__(self):
        # The way since it was last made: of the present sample, lowest, highest; and the mean drive when it was made.
        self._at, self._low, self._high = (Signal(signed(9), name=name) for name in ("at", "low", "high"))
        self._mean, self._reference = Signal(signed(13 + MEAN_BITS)), Signal(signed(13))
        self._forward = Signal()            # the excess of the last sample
        self._strong_for, self._weak_for = Signal(17), Signal(17)
        super().__init__({"stb": In(1), "window": In(1), "step": In(signed(STEP_BITS)), "drive": In(signed(13)), "hold": In(1),
                          "limits": In(ProgressLimits), "fault": Out(1)})

    def elaborate(self, platform):
        m = Module()
        limits = self.limits
        at, low, high = (Signal(signed(10)) for _ in range(3))
        made = Signal()
        m.d.comb += [
            at.eq(self._at + self.step),
            low.eq(Mux(at < self._low, at, self._low)), high.eq(Mux(at > self._high, at, self._high)),
            made.eq(high - low >= limits.way),
        ]
        with m.If(self.stb):
            m.d.sync += [old.eq(Mux(made, 0, new)) for old, new in ((self._at, at), (self._low, low), (self._high, high))]
            with m.If(made):
                m.d.sync += self._reference.eq(self._mean >> MEAN_BITS)
        with m.If(self.window):
            m.d.sync += self._mean.eq(self._mean + self.drive - (self._mean >> MEAN_BITS))

        excess, magnitude, forward, holds = Signal(signed(14)), Signal(14), Signal(), Signal()
        m.d.comb += excess.eq(self.drive - Mux(self.hold, self._reference, 0))
        m.d.sync += [magnitude.eq(Mux(excess < 0, -excess, excess)), forward.eq(excess >= 0), holds.eq(self.hold)]
        strong, weak = (magnitude >= limits.strong) & ~holds, magnitude >= Mux(holds, limits.held, limits.breakaway)
        with m.If(self.stb):
            m.d.sync += self._forward.eq(forward)
            for run, counts, most in ((self._strong_for, strong, limits.strong_samples),
                                      (self._weak_for, weak, limits.samples)):
                with m.If(made | ~counts | (forward != self._forward)):
                    m.d.sync += run.eq(counts & ~made)
                with m.Elif(run <= most):
                    m.d.sync += run.eq(run + 1)
        m.d.comb += self.fault.eq((self._strong_for > limits.strong_samples) | (self._weak_for > limits.samples))
        return m


class Overspeed(wiring.Component):
    """Further in a window than may be.  Domain ``sync``.

    Members
    -------
    stb, window : In(1)
        A sample; with ``window`` it is the last of a window.
    step : In(signed(STEP_BITS))
        With ``stb``: counts since the sample before.
    limit : In(16)
        Counts in a window, in either direction.
    fault : Out(1)
        The last whole window went further, net; from the clock after its end.  From a flip-flop.
    """

    stb: In(1)
    window: In(1)
    step: In(signed(STEP_BITS))
    limit: In(16)
    fault: Out(1)

    def __init__(self):
        super().__init__()
        self._way = Signal(signed(16))

    def elaborate(self, platform):
        m = Module()
        way = Signal(signed(17))
        m.d.comb += way.eq(self._way + self.step)
        with m.If(self.window):
            m.d.sync += [self._way.eq(0), self.fault.eq(Mux(way < 0, -way, way) > self.limit)]
        with m.Elif(self.stb):
            m.d.sync += self._way.eq(way)
        return m


class Following(wiring.Component):
    """Elsewhere than expected.  Domain ``sync``.

    Members
    -------
    count, expected : In(signed(32))
        Both wrap.
    most : In(31)
        Counts by which they may differ.
    armed : In(1)
    fault : Out(1)
        Armed, and 2 clocks ago they differed by more and it was armed.
    """

    count: In(signed(32))
    expected: In(signed(32))
    most: In(31)
    armed: In(1)
    fault: Out(1)

    def __init__(self):
        super().__init__()
        self._error, self._was_armed, self._far = Signal(signed(32)), Signal(), Signal()

    def elaborate(self, platform):
        m = Module()
        m.d.sync += [
            self._error.eq(self.count - self.expected), self._was_armed.eq(self.armed),
            self._far.eq(self._was_armed & ((self._error > self.most) | (self._error < -self.most))),
        ]
        m.d.comb += self.fault.eq(self.armed & self._far)
        return m


class Budget(wiring.Component):
    """More events in a time than may be.  Domain ``sync``.

    Members
    -------
    event : In(1)
        One-clock strobe.
    window : In(1)
        One-clock strobe, the unit of ``length``.
    most : In(8)
        Events that are allowed.
    length : In(16)
        Windows after which the count begins anew; 0 is 65536.  Taken then.
    fault : Out(1)
        There were more, from the clock after the first too many to the end of its time.
    """

    event: In(1)
    window: In(1)
    most: In(8)
    length: In(16)
    fault: Out(1)

    def __init__(self):
        super().__init__()
        self._events, self._left = Signal(9), Signal(16)

    def elaborate(self, platform):
        m = Module()
        again = Signal()
        m.d.comb += [again.eq(self.window & (self._left == 0)), self.fault.eq(self._events > self.most)]
        with m.If(self.window):
            m.d.sync += self._left.eq(Mux(again, self.length - 1, self._left - 1))
        with m.If(again):
            m.d.sync += self._events.eq(self.event)
        with m.Elif(self.event & ~self._events[-1]):
            m.d.sync += self._events.eq(self._events + 1)
        return m
