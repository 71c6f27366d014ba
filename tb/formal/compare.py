# SPDX-License-Identifier: BSD-2-Clause
"""Position compare: fires once per arming at most, and always when the edge is crossed.

The reference works on the steps themselves, in whole 32-bit numbers and without a pipeline: it asks which two
counts a step joins, and whether the reference edge lies between them.
"""

from amaranth import Cat, Mux, Signal, signed

from tb.formal.proof import AnySeq, Assert, Assume, Cover, Proof, one_clock


def stepping(m, jump):
    """An axis: (moved, up, count before, count after), any steps; anywhere else after ``jump``."""
    first, last = Signal(init=1), Signal(signed(32))
    moved, up, before, count = Signal(), Signal(), Signal(signed(32)), Signal(signed(32))
    m.d.formal += [first.eq(0), last.eq(count)]
    m.d.comb += [
        moved.eq(AnySeq(1)), up.eq(AnySeq(1)),
        before.eq(Mux(first | jump, AnySeq(32), last)),
        count.eq(Mux(moved, Mux(up, before + 1, before - 1), before)),
    ]
    return moved, up, before, count


class FiresOncePerArming(Proof):
    """Any steps, armings, disarmings and settings: at most once per arming, always when crossed, never when late."""

    block = "rtl.compare"
    depth = 6
    cover_depth = 14
    bug_depth = 12
    widths = "count and reference 32, either direction"
    bugs = {
        "it stays armed": ("(self.armed & ~crossed)", "self.armed"),
        "it fires at a count that it comes to backward": ("self.step.up ^ reverse", "~self.step.up ^ reverse"),
        "late is judged in one direction": ("at | ~(below ^ reverse)", "at | ~below"),
        "one byte is not compared": ("at.eq(equal.all())", "at.eq(equal[1:].all())"),
        "the edge is taken for a count": ("self.settings.reference - reverse", "self.settings.reference"),
        "the borrow is lost": ("Mux(no_borrow, signs[0], signs[1])", "signs[0]"),
        "the answer comes before the verdict shows": ("self.judged.eq(answering[1])", "self.judged.eq(answering[0])"),
        "a disarming comes too late": ("judging.eq(sampled & ~ending)", "judging.eq(sampled)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.PositionCompare(), "fast")
        arm, disarm, done = Signal(), Signal(), Signal()
        reference, reverse = Signal(signed(32)), Signal()
        ending, armed_before = Signal(), Signal()
        ended = Signal(3)                       # one clock before, two, three
        moved, up, before, count = stepping(m, armed_before)
        m.d.comb += [
            arm.eq(AnySeq(1)), disarm.eq(AnySeq(1)), done.eq(AnySeq(1)), ending.eq(arm | disarm),
            reference.eq(AnySeq(32)), reverse.eq(AnySeq(1)),
            dut.arm.eq(arm), dut.disarm.eq(disarm), dut.done.eq(done),
            dut.settings.reference.eq(reference), dut.settings.reverse.eq(reverse),
            dut.step.moved.eq(moved), dut.step.up.eq(up), dut.step.count.eq(count),
        ]
        # Settings change with an arming only.
        settings, settings_before = Cat(reference, reverse), Signal(33)
        m.d.formal += [settings_before.eq(settings), armed_before.eq(arm & ~disarm), ended.eq(Cat(ending, ended))]
        m.d.comb += Assume(arm | (settings == settings_before))

        # Edge e joins counts e - 1 and e.
        crossed, reached, ahead = Signal(), Signal(), Signal(signed(32))
        m.d.comb += [
            crossed.eq(moved & Mux(reverse, ~up & (before == reference), up & (count == reference))),
            ahead.eq(Mux(reverse, count - reference + 1, reference - count)),
            # At exactly half of all counts away both ways are equally long; that is ahead going up.
            reached.eq(Mux(ahead == -2**31, reverse, ahead <= 0)),
        ]

        # Seen by the block 2 steps later: what the steps say, unless something ended it meanwhile.
        waiting, late, fire, waiting_before, late_before = (Signal() for _ in range(5))
        m.d.formal += [fire.eq(waiting & crossed & ~ending), waiting_before.eq(waiting & ~ending),
                       late_before.eq(late & ~ending)]
        with m.If(ending):
            m.d.formal += [waiting.eq(0), late.eq(0)]
        with m.Elif(armed_before):
            m.d.formal += [waiting.eq(~reached), late.eq(reached)]
        with m.Elif(crossed):
            m.d.formal += waiting.eq(0)
        fired, active = Signal(), Signal()
        m.d.formal += fired.eq(fire & ~ending)
        with m.If(ending):
            m.d.formal += active.eq(0)
        with m.Elif(fire):
            m.d.formal += active.eq(1)
        with m.Elif(done):
            m.d.formal += active.eq(0)
        m.d.comb += [
            Assert(dut.fired == fired), Assert(dut.active == active),
            Assert(dut.armed == waiting_before), Assert(dut.late == late_before), Assert(dut.judged == ended[2]),
        ]

        # Counted at the block's own output.
        fires = Signal(2)
        with m.If(ending):
            m.d.formal += fires.eq(0)
        with m.Elif(dut.fired):
            m.d.formal += fires.eq(fires + 1)
        m.d.comb += [
            Assert(fires + dut.fired <= 1),
            Assert(~((fires != 0) | fired) | ~(waiting | waiting_before | fire)),
            Assert(~fire | ~waiting), Assert(~(waiting & late)), Assert(~(waiting_before & late_before)),
        ]

        m.d.comb += [
            Cover(dut.fired & reverse & (reference == 7)), Cover(dut.fired & ~reverse & (fires == 0) & (count < 0)),
            Cover(dut.late & (count == 5)), Cover(dut.active & crossed),
        ]
