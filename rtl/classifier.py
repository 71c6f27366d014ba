# SPDX-License-Identifier: BSD-2-Clause
"""Short pulses and long ones: what a TTL input says to the servo lock, pulse by pulse and in order."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from rtl.countdown import Countdown

__all__ = ["BATCH", "CLASSIFIER_LATENCY", "ClassifierSettings", "DecisionBatch", "PulseClassifier"]

CLASSIFIER_LATENCY = 2
"""``fast`` clocks from the clock that shows the level that decides to the clock that shows the decision."""

THRESHOLD_BITS = 32

BATCH = 8
"""Decisions that may wait together to cross to ``sync``."""


ClassifierSettings = data.StructLayout({"threshold": THRESHOLD_BITS, "at_threshold": 1, "enable": 1})
"""``threshold``: clocks from which on a pulse is long, at least 1.  ``at_threshold``: decide at the threshold only.
``enable``: 0 forgets the pulse under way."""


class PulseClassifier(wiring.Component):
    """Judge every pulse: short if it is high for less than ``threshold`` clocks, else long.

    Domain ``fast``.  A long pulse is judged by clock number ``threshold`` of it, while it is still high; a short one by
    the clock that follows it.  So two pulses of which one is one clock longer are told apart, and every low clock
    between two pulses parts them.

    With ``at_threshold`` the level in clock number ``threshold`` after the rise decides, high or low, and nothing
    before: rises in between are not pulses of their own.

    Members
    -------
    level : In(1)
    settings : In(ClassifierSettings)
        ``threshold`` is taken as it was in the clock before a rise.  A pulse that began before ``enable`` is not
        judged.
    decided : Out(1)
        One-clock strobe from a flip-flop, once for each pulse, :data:`CLASSIFIER_LATENCY` clocks after what decides.
    long : Out(1)
        With ``decided``: it was long.  Otherwise meaningless.
    """

    def __init__(self):
        self._countdown = Countdown(width=THRESHOLD_BITS)
        # State, for proofs.  ``was``: the level a clock ago.  ``timing``: a pulse is not judged yet.
        self._was, self._timing = Signal(init=1), Signal()
        super().__init__({"level": In(1), "settings": In(ClassifierSettings), "decided": Out(1), "long": Out(1)})

    def elaborate(self, platform):
        m = Module()
        m.submodules.countdown = countdown = self._countdown
        was, timing, settings = self._was, self._timing, self.settings

        begin, end = Signal(), Signal()
        m.d.comb += [
            end.eq(timing & (countdown.last | ~(was | settings.at_threshold))),
            begin.eq(self.level & ~was & (end | ~timing)),
            countdown.value.eq(settings.threshold), countdown.load.eq(begin), countdown.step.eq(timing),
        ]
        m.d.fast += [
            was.eq(self.level),
            timing.eq((begin | (timing & ~end)) & settings.enable),
            self.decided.eq(end & settings.enable), self.long.eq(was),
        ]
        return m


class DecisionBatch(wiring.Component):
    """Gather decisions until they are taken, in order.

    Domain ``fast``.

    Members
    -------
    decided, long : In(1)
        A decision, in any clock.
    take : In(1)
        Strobe: ``batch`` has been copied; it is empty as of the next clock, but for a decision of this one.
    batch : Out(9)
        A 1, and behind it, toward bit 0, the decisions in their order: 1 long, 0 short.  1 if there is none.
    waiting : Out(1)
        There is one.
    lost : Out(16)
        Decisions that found :data:`BATCH` others before them, since reset.  Stays at 65535.
    """

    def __init__(self):
        # State, for proofs.  ``_lost_full``: ``lost`` is at its last value.
        self._lost_full = Signal()
        super().__init__({"decided": In(1), "long": In(1), "take": In(1), "batch": Out(BATCH + 1, init=1),
                          "waiting": Out(1), "lost": Out(16)})

    def elaborate(self, platform):
        m = Module()
        full, refused = Signal(), Signal()
        m.d.comb += [full.eq(self.batch[BATCH]), refused.eq(self.decided & full & ~self.take)]
        with m.If(self.take):
            m.d.fast += [self.batch.eq(Mux(self.decided, 0b10 | self.long, 1)), self.waiting.eq(self.decided)]
        with m.Elif(self.decided & ~full):
            m.d.fast += [self.batch.eq(self.batch << 1 | self.long), self.waiting.eq(1)]

        another = refused & ~self._lost_full
        with m.If(another):
            m.d.fast += self.lost.eq(self.lost + 1)
        m.d.fast += self._lost_full.eq(self.lost[1:].all() & (self.lost[0] | another))
        return m
