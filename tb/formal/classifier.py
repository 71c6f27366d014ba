# SPDX-License-Identifier: BSD-2-Clause
"""Every pulse is judged once, by its length; no decision is lost, made up or turned on its way."""

from amaranth import Mux, Signal

from tb.formal.divider import register, steps_left
from tb.formal.proof import AnyConst, AnySeq, Assert, Assume, Cover, Proof, one_clock


class EveryPulseIsJudgedOnce(Proof):
    """For every input and threshold: the decisions are those of a counter of the clocks that the level has been high,
    or, with ``at_threshold``, of the clocks since the rise."""

    block = "rtl.classifier"
    depth = 4
    cover_depth = 16
    bug_depth = 12
    widths = "threshold 32"
    bugs = {
        "a clock too long": ("countdown.last | ~(was |", "countdown.last & ~self.level | ~(was |"),
        "the level of the next clock decides": ("self.long.eq(was)", "self.long.eq(self.level)"),
        "a rise right behind a pulse is missed": ("~was & (end | ~timing)", "~was & ~timing"),
        "a pulse is judged twice": ("(timing & ~end)) &", "timing) &"),
        "the decision waits for the threshold": ("~(was | settings.at_threshold)", "0"),
        "disabled, it goes on": ("(timing & ~end)) & settings.enable", "(timing & ~end))"),
        "high when enabled is a rise": ("Signal(init=1), Signal()", "Signal(init=0), Signal()"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.PulseClassifier(), "fast")
        level, enable, threshold, at = Signal(), Signal(), Signal(32), AnyConst(1)
        m.d.comb += [
            level.eq(AnySeq(1)), enable.eq(AnySeq(1)), threshold.eq(AnySeq(32)), Assume(threshold != 0),
            dut.level.eq(level), dut.settings.enable.eq(enable), dut.settings.threshold.eq(threshold),
            dut.settings.at_threshold.eq(at),
        ]

        # Of the clock before: its level, and if it belongs to a pulse, its number in it, and the pulse's threshold.
        was = register(m, 1, level, init=1)
        rose = was & ~register(m, 1, was, init=1) & register(m, 1, enable)
        under_way, before, kept = Signal(), Signal(32), Signal(32)
        pulse, number, limit = under_way | rose, Signal(32), Signal(32)
        m.d.comb += [number.eq(Mux(under_way, before + 1, 1)),
                     limit.eq(Mux(under_way, kept, register(m, 32, register(m, 32, threshold))))]
        long = pulse & was & (number == limit)
        short = pulse & ~was & (~at | (number == limit))
        m.d.formal += [under_way.eq(pulse & ~long & ~short & enable), before.eq(number), kept.eq(limit)]

        due = register(m, 1, (long | short) & enable)
        m.d.comb += [
            Assert(dut.decided == due), Assert(~due | (dut.long == register(m, 1, long))),
            *self.lemmas(dut._was == was, dut._timing == pulse, ~pulse | (number <= limit), ~pulse | (limit != 0)),
            Cover(due & dut.long & (register(m, 32, limit) == 5)),
            Cover(due & ~dut.long & register(m, 1, pulse & (number == 3)) & pulse),
        ]
        if self._with_lemmas:
            steps_left(m, dut._countdown, limit - number + 1, pulse)


class DecisionsKeepTheirOrder(Proof):
    """Any decisions, taken at any time: every one that is not counted as lost leaves in its place, and nothing else."""

    block = "rtl.classifier"
    depth = 3
    cover_depth = bug_depth = 12
    widths = "batch 8, lost 16"
    bugs = {
        "the one that comes as they are taken is lost": ("Mux(self.decided, 0b10 | self.long, 1)", "1"),
        "and nobody is told": ("self.waiting.eq(self.decided)", "self.waiting.eq(0)"),
        "the ninth pushes the first out": ("self.decided & ~full", "self.decided"),
        "a full one that is taken refuses": ("full & ~self.take", "full"),
        "in the wrong order": ("self.batch << 1 | self.long", "self.batch << 1 | ~self.long"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.DecisionBatch(), "fast")
        decided, long, take = Signal(), Signal(), Signal()
        m.d.comb += [decided.eq(AnySeq(1)), long.eq(AnySeq(1)), take.eq(AnySeq(1)),
                     dut.decided.eq(decided), dut.long.eq(long), dut.take.eq(take)]
        # A queue as a row of numbered places.
        row, used, lost = [Signal(name=f"place{n}") for n in range(block.BATCH)], Signal(4), Signal(16)
        with m.If(take):
            m.d.formal += [used.eq(decided), row[0].eq(long)]
        with m.Elif(decided & (used == block.BATCH)):
            m.d.formal += lost.eq(lost + (lost != 0xffff))
        with m.Elif(decided):
            m.d.formal += used.eq(used + 1)
            with m.Switch(used):
                for n, place in enumerate(row):
                    with m.Case(n):
                        m.d.formal += place.eq(long)
        for n in range(block.BATCH + 1):
            # n decisions: the first of them just below the 1.
            expected = 1 << n
            for k in range(n):
                expected = expected | row[k] << n - 1 - k
            m.d.comb += Assert((used != n) | (dut.batch == expected))
        m.d.comb += [
            Assert(used <= block.BATCH), Assert(dut.waiting == (used != 0)), Assert(dut.lost == lost),
            *self.lemmas(dut._lost_full == (lost == 0xffff)),
            Cover((lost == 2) & (dut.batch == 0b101100111)), Cover(take & (used == block.BATCH) & decided),
        ]
