# SPDX-License-Identifier: BSD-2-Clause
"""A record holds the counts of one sample, whatever the filters, stands for one pulse, and reaches the queue."""

from amaranth import Const, Mux, Signal, signed

from tb.formal.crossing import Strobes
from tb.formal.divider import register
from tb.formal.proof import AnyConst, AnySeq, Assert, Assume, Cover, Proof, one_clock, two_clocks

FILTER = 4


class ARecordIsOneSample(Proof):
    """Any pins, counts and filters that change by anything at any clock: the counts of a record are those that the axes
    showed 2 clocks, and the filter's of the rise, after it; its time that of 1 clock after.  They stand until the next
    rise."""

    block = "rtl.trigger"
    axes, width = 2, 2
    mode = "prove"
    depth = 24
    cover_depth = 44
    bug_depth = 60
    widths = "2 counts of 2 bits, filters 4, minimum 18 and 19"
    bugs = {
        "the filter is not waited for": ("Array(age)[chosen]", "age[0]"),
        "a clock late": ("age.eq(Cat(rise, age))", "age.eq(Cat(age[0], age) << 1 | rise)"),
        "the filter of now": ("chosen.eq(self.filter[n])", "chosen.eq(self.filter[0])"),
        "the time of the rise itself": ("with m.If(age[0])", "with m.If(rise)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.TriggerCapture(axes=self.axes, width=self.width), "fast")
        time, level, minimum = Signal(3), Signal(), AnyConst(1)
        m.d.comb += [
            level.eq(AnySeq(1)), dut.level.eq(level), dut.settings.enable.eq(AnySeq(1)),
            dut.settings.minimum.eq(block.MINIMUM + minimum),
            time.eq(AnySeq(3)), dut.time.eq(time),
        ]
        was = register(m, 1, level, init=1)
        rise = level & ~was
        age = Signal(5)                             # clocks since the last rise, this one 0; 31 means more
        before = register(m, 5, age, init=31)
        m.d.comb += age.eq(Mux(rise, 0, before + (before != 31)))
        moment, stands = Signal(3), Signal()
        m.d.formal += stands.eq((dut.record | stands) & ~rise)
        with m.If(age == 1):
            m.d.formal += moment.eq(time)
        for n in range(self.axes):
            count, chosen = Signal(signed(self.width)), Signal(signed(self.width))
            filter_, of_rise = Signal(FILTER), Signal(FILTER)
            m.d.comb += [
                count.eq(AnySeq(signed(self.width))), dut.count[n].eq(count), filter_.eq(AnySeq(FILTER)), dut.filter[n].eq(filter_),
            ]
            with m.If(rise):
                m.d.formal += of_rise.eq(filter_)
            with m.If(age == 2 + of_rise):
                m.d.formal += chosen.eq(count)
            stood = register(m, signed(self.width), dut.o.counts[n])
            m.d.comb += [
                Assert(~dut.record | (dut.o.counts[n] == chosen)), Assert(~stands | (dut.o.counts[n] == stood)),
                *self.lemmas(~dut._pulse | (dut._filters[n] == of_rise)),
            ]
        m.d.comb += [
            Assert(~dut.record | (dut.o.moment[:3] == moment)), Cover(dut.record & (chosen == -2)),
            *self.lemmas(dut._was == was, dut._idle | (dut._last == (dut._left == 1)), ~(dut._idle & dut._pulse),
                         ~dut._pulse | ((age == dut.settings.minimum - dut._left) & (dut._left != 0))),
        ]


class ARecordIsOnePulse(Proof):
    """Any pin: a record comes as a pulse has lasted long enough, once, and after a pause that has.  Records are
    at least twice the minimum apart."""

    block = "rtl.trigger"
    axes, width = 1, 1
    depth = 3
    cover_depth, bug_depth = 40, 60
    widths = "minimum 8"
    bugs = {
        "a clock too short": ("left.eq(minimum - 1)", "left.eq(minimum - 2)"),
        "a pause with a break": ("Mux(pulse, last, self.level)", "pulse & last"),
        "a glitch makes a pause": ("idle.eq(~self.level),", "idle.eq(0),"),
        "a pulse without end": ("pulse.eq(self.level & ~last)", "pulse.eq(self.level)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.TriggerCapture(axes=self.axes, width=self.width), "fast")
        level, enable = Signal(), Signal()
        minimum = AnyConst(8) if self._with_lemmas else Const(block.MINIMUM, 8)         # bugs are found sooner
        started = register(m, 1, 1)
        m.d.comb += [
            level.eq(AnySeq(1)), dut.level.eq(level), enable.eq(AnySeq(1)), dut.settings.enable.eq(enable),
            dut.settings.minimum.eq(minimum),
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
            counted.eq(rise | (counted & level & ~whole)),
            rested.eq((rested & ~rise) | (counted & ~level) | (~rested & ~counted & ~level & (lasted >= minimum))),
        ]
        since = Signal(9, init=511)                 # clocks from the last record to this clock; 511: at least, or none
        m.d.formal += since.eq(Mux(dut.record, 1, since + (since != 511)))
        m.d.comb += [
            Assert(dut.record == register(m, 1, whole)), Assert(~dut.record | (since == 511) | (since >= 2 * minimum)),
            *self.lemmas(dut._was == level_before, dut._idle == rested, dut._pulse == counted, ~(rested & counted),
                         rested | ~started | (dut._last == (dut._left == 1))),
            Cover(dut.record),
        ]
        if self._with_lemmas:
            # What is left of a pulse or pause is what it has not lasted yet.
            unbroken = counted | ~level_before
            left = minimum - Mux(unbroken, lasted_before, 0)
            m.d.comb += Assert(rested | ~started | ((dut._left == left) & (left[:8] != 0) & (left >= 0)))
            kept = minimum - dut._left
            m.d.comb += Assert((since == 511) | (since >= Mux(rested, minimum, Mux(counted, minimum + kept, kept))))


class ARecordReachesTheQueue(Proof):
    """Records come to the queue once each, in order, whole and before the next is given, at the product's clocks, at
    any phase, with any synchroniser late: if they are as far apart as the pulses they are of.  Each that was given is
    on its way, waits, was taken, or is counted as missed."""

    block = "rtl.trigger"
    depth = 8
    cover_depth, bug_depth = 50, 60
    widths = "record 8, queue of 1, fast at 4 times sync, synchronisers late or not"
    bugs = {
        "the record is copied a clock late": ("hold.take.eq(crossing.sent)", "hold.take.eq(crossing._kept)"),
        "a record is queued twice": ("fifo.w_en.eq(crossing.o)", "fifo.w_en.eq(crossing.o | crossing._seen)"),
        "a record is not queued": ("fifo.w_en.eq(crossing.o)", "fifo.w_en.eq(crossing.o & ~crossing._seen)"),
        "a record that finds no room is not counted": ("crossing.o & ~fifo.w_rdy &", "0 &"),
        "a record that finds room is counted": ("crossing.o & ~fifo.w_rdy &", "crossing.o &"),
    }

    def harness(self, m, block):
        tick, phase = Signal(), Signal(2)
        dut = block.RecordQueue(8, depth=1)
        m.submodules.dut, synchronisers = two_clocks(dut, fast=Const(1), sync=tick)
        # The first clock of ``sync`` is any of the first four of ``fast``.
        m.d.comb += tick.eq(phase == AnyConst(2))
        m.d.formal += phase.eq(phase + 1)
        since = Signal(6, init=63)                  # clocks of ``fast`` since the last record
        m.d.comb += [
            dut.given.eq(AnySeq(1)), dut.i.eq(AnySeq(8)), dut.take.eq(AnySeq(1)),
            Assume(~dut.given | (since >= 2 * block.MINIMUM)),
        ]
        m.d.formal += since.eq(Mux(dut.given, 1, since + (since != 63)))
        account = Strobes(m, dut._crossing, tick=Const(1), tock=tick)
        m.d.comb += self.lemmas(*account.lemmas(dut._crossing, synchronisers), ~account.waiting)

        given, waiting = Signal(8), Signal()        # the last record, and that it has not come yet
        came = tick & dut._fifo.w_en
        with m.If(dut.given):
            m.d.formal += given.eq(dut.i)
        with m.If(dut.given | came):
            m.d.formal += waiting.eq(dut.given)
        total, taken = Signal(4), Signal(4)
        m.d.formal += [
            total.eq(total + dut.given), taken.eq(taken + (tick & dut.take & dut._fifo.r_rdy)),
        ]
        m.d.comb += [
            Assert(~came | (waiting & (dut._fifo.w_data == given))), Assert(~dut.given | ~waiting),
            Assert(~waiting | (since <= 24)),
            Assert(dut.missed.all() | (total == (taken + dut.level + dut.missed + waiting)[:4])),
            Cover(came & (given == 0x5a) & (total == 2)),
            *self.lemmas(waiting == account.flying, ~waiting | (dut._hold.o == given),
                         dut._crossing.ready | (since <= 24 + 4),
                         ~account.flying | (since <= 4 * account.there_ticks + 4)),
        ]


class LostRecordsAreCounted(Proof):
    """Any records at any time, of one clock: ``missed`` rises by one with a record that comes and finds no room, stays at
    its last value, and changes with nothing else."""

    block = "rtl.trigger"
    shape, queue = 8, 1
    depth = 2
    cover_depth = bug_depth = 30
    widths = "record 8, queue of 1, missed 32"
    bugs = {
        "a record that finds room is counted": ("crossing.o & ~fifo.w_rdy &", "crossing.o &"),
        "a record that finds no room is not counted": ("crossing.o & ~fifo.w_rdy &", "0 &"),
        "they are counted by two": ("self.missed + 1", "self.missed + 2"),
    }

    def harness(self, m, block):
        dut = block.RecordQueue(self.shape, depth=self.queue)
        m.submodules.dut = one_clock(one_clock(dut, "fast"), "sync")
        lost, last = dut._fifo.w_en & ~dut._fifo.w_rdy, (1 << len(dut.missed)) - 1
        m.d.comb += [
            dut.given.eq(AnySeq(1)), dut.i.eq(AnySeq(self.shape)), dut.take.eq(AnySeq(1)),
            Assert(dut.missed == register(m, len(dut.missed), Mux(dut.missed == last, last, dut.missed + lost))),
            Cover(dut.missed == 2),
        ]
