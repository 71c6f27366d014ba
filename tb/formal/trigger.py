# SPDX-License-Identifier: BSD-2-Clause
"""A record holds the counts of one sample, whatever the filters, and stands for one pulse."""

from amaranth import Const, Mux, Signal, signed

from tb.formal.divider import register
from tb.formal.proof import AnyConst, AnySeq, Assert, Assume, Cover, Proof, one_clock

FILTER = 4


class ARecordIsOneSample(Proof):
    """Any pins, counts that change by anything at any clock, any pair of filters: the counts of a record are those that
    the axes showed 2 clocks, and their filter's, after the rise; its time that of 1 clock after.  They stand until a
    rise while ``ready``."""

    block = "rtl.trigger"
    mode = "prove"
    depth = 24
    cover_depth = 44
    bug_depth = 60
    widths = "2 counts of 2 bits, filters 4, minimum 18 and 19"
    bugs = {
        "the filter is not waited for": ("Array(age)[self.filter[n]]", "age[0]"),
        "a clock late": ("age.eq(Cat(begin, age))", "age.eq(Cat(age[0], age) << 1 | begin)"),
        "a missed rise takes the counts": ("Cat(begin, age)", "Cat(rise, age)"),
        "the time of the rise itself": ("with m.If(age[0])", "with m.If(begin)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.TriggerCapture(axes=2, width=2), "fast")
        time, level, ready, minimum = Signal(3), Signal(), Signal(), AnyConst(1)
        m.d.comb += [
            level.eq(AnySeq(1)), dut.level.eq(level), dut.settings.enable.eq(AnySeq(1)),
            ready.eq(AnySeq(1)), dut.ready.eq(ready), dut.settings.minimum.eq(block.MINIMUM + minimum),
            time.eq(AnySeq(3)), dut.time.eq(time),
        ]
        was = register(m, 1, level, init=1)
        rise = level & ~was
        age = Signal(5)                             # clocks since the last rise, this one 0; 31 means more
        before = register(m, 5, age, init=31)
        m.d.comb += age.eq(Mux(rise, 0, before + (before != 31)))
        moment, stands = Signal(3), Signal()
        m.d.formal += stands.eq((dut.record | stands) & ~(rise & ready))
        with m.If(age == 1):
            m.d.formal += moment.eq(time)
        for n in range(2):
            count, chosen, filter_ = Signal(signed(2)), Signal(signed(2)), AnyConst(FILTER)
            m.d.comb += [count.eq(AnySeq(signed(2))), dut.count[n].eq(count), dut.filter[n].eq(filter_)]
            with m.If(age == 2 + filter_):
                m.d.formal += chosen.eq(count)
            stood = register(m, signed(2), dut.counts[n])
            m.d.comb += [Assert(~dut.record | (dut.counts[n] == chosen)), Assert(~stands | (dut.counts[n] == stood))]
        m.d.comb += [
            Assert(~dut.record | (dut.moment[:3] == moment)), Cover(dut.record & (chosen == -2)),
            *self.lemmas(dut._was == was, ~dut._pulse | ((age == dut.settings.minimum - dut._left) & (dut._left != 0))),
        ]


class ARecordIsOnePulse(Proof):
    """Any pin: a record comes as a pulse has lasted long enough, once, and after a pause that has; every rise then is a
    pulse, a glitch, or said to be missed."""

    block = "rtl.trigger"
    depth = 3
    cover_depth = bug_depth = 40
    widths = "minimum 8"
    bugs = {
        "a clock too short": ("minimum - self.ready", "minimum - 1 - self.ready"),
        "a pause with a break": ("with m.If(self.level):\n", "with m.If(0):\n"),
        "a glitch makes a pause": ("m.d.fast += idle.eq(1)", "m.d.fast += idle.eq(0)"),
        "a pulse without end": ("pulse.eq(self.level & ~last)", "pulse.eq(self.level)"),
        "a miss is not told": ("self.missed.eq(~self.ready)", "self.missed.eq(0)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.TriggerCapture(axes=1, width=1), "fast")
        level, enable, ready = Signal(), Signal(), Signal()
        minimum = AnyConst(8) if self._with_lemmas else Const(block.MINIMUM, 8)         # bugs are found sooner
        started = register(m, 1, 1)
        m.d.comb += [
            level.eq(AnySeq(1)), dut.level.eq(level), enable.eq(AnySeq(1)), dut.settings.enable.eq(enable),
            ready.eq(AnySeq(1)), dut.ready.eq(ready), dut.settings.minimum.eq(minimum),
            Assume(minimum >= block.MINIMUM), Assume(started | level),      # with another minimum, from reset on
        ]
        # Clocks that the level has been as it is, up to now; whether a pause was kept, and a pulse is being counted.
        level_before = register(m, 1, level, init=1)
        lasted = Signal(9)
        lasted_before = register(m, 9, lasted)
        m.d.comb += lasted.eq(Mux(level != level_before, 1, lasted_before + (lasted_before != 511)))
        rested, counted = Signal(), Signal()
        rise = level & ~level_before & rested & enable
        whole = counted & level & (lasted == minimum)
        m.d.formal += [
            counted.eq((rise & ready) | (counted & level & ~whole)),
            rested.eq((rested & ~rise) | (counted & ~level) | (~rested & ~counted & ~level & (lasted >= minimum))),
        ]
        m.d.comb += [
            Assert(dut.record == register(m, 1, whole)), Assert(dut.missed == register(m, 1, rise & ~ready)),
            *self.lemmas(dut._was == level_before, dut._idle == rested, dut._pulse == counted, ~(rested & counted)),
            Cover(dut.record), Cover(dut.missed),
        ]
        if self._with_lemmas:
            # What is left of a pulse or pause is what it has not lasted yet.
            unbroken = counted | ~level_before
            left = minimum - Mux(unbroken, lasted_before, 0)
            m.d.comb += Assert(rested | ~started | ((dut._left == left) & (left[:8] != 0) & (left >= 0)))
