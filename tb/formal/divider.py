# SPDX-License-Identifier: BSD-2-Clause
"""The pixel divider follows its recurrence at full width; its counters count.

The references are plain numbers: steps left, distance behind the front, and the 64-bit sum S <- S + N whose
upper half says at which progress the next pixel is due.  Induction also needs to know how the block's counters,
which are split so as to be fast, stand for those numbers; :func:`steps_left` and :func:`distance` say it.
"""

from amaranth import Cat, Mux, Signal, signed

from tb.formal.compare import stepping
from tb.formal.proof import AnySeq, Assert, Assume, Cover, Proof, one_clock


def register(m, shape, value, **kwargs):
    """The value one step later."""
    result = Signal(shape, **kwargs)
    m.d.formal += result.eq(value)
    return result


def steps_left(m, inside, left, valid):
    """Assert that a Countdown, if ``valid``, stands for ``left`` steps (33 bits, 1 or more)."""
    high = Signal(len(inside._high))
    count = Signal(33)
    m.d.comb += [
        high.eq(Mux(inside._began, inside._start[8:], inside._high - inside._borrow - inside._due)),
        count.eq(Cat(inside._low, high)),
    ]
    counting = (inside._one == (count == 1)) & (left == count + inside._more)
    # The extra step itself is taken with the count at 0.
    extra = (inside._low == 0) & inside._one & ~inside._more & (left == 1)
    # Only for 3 clocks after the low byte went below 0 is it not known that the rest is zero.
    recent = (inside._low == 255) | ((inside._low == 254) & ~inside._borrow) | (
        (inside._low == 253) & ~inside._borrow & ~inside._due)
    known = (inside._short == (high == 0)) | (~inside._short & recent)
    m.d.comb += [
        Assert(inside._start_one == (inside._start == 1)),
        Assert(inside._start_short == (inside._start[8:] == 0)),
        Assert(~valid | (inside.last == (left == 1))),
        Assert(~valid | extra | (counting & known & (count != 0))),
        Assert(~valid | ~inside._borrow | inside._began | (inside._low == 255)),
        Assert(~valid | ~inside._due | inside._began | ((inside._low >= 254) & ~inside._borrow
                                                       & (inside._less == inside._high - 1))),
    ]


class CountdownCounts(Proof):
    """Any value, loads, reloads, extra and other steps, one in every clock: ``last`` exactly before the last."""

    block = "rtl.countdown"
    depth = 4
    cover_depth = 14
    bug_depth = 12
    widths = "value 32"
    bugs = {
        "the extra step is forgotten": ("more.eq(Mux(again, self.extra,", "more.eq(Mux(again, 0,"),
        "the upper bytes are not looked at": ("two.eq(short & (low == 2))", "two.eq(low == 2)"),
        "a reload with 1 is not seen": ("one.eq(Mux(again, start_one,", "one.eq(Mux(again, 0,"),
        "a load does not win over a step": ("with m.If(begin):", "with m.If(begin & ~self.step):"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Countdown(width=32), "fast")
        value, load, reload, extra, step = Signal(32), Signal(), Signal(), Signal(), Signal()
        for signal, pin in ((value, dut.value), (load, dut.load), (reload, dut.reload), (extra, dut.extra),
                            (step, dut.step)):
            m.d.comb += [signal.eq(AnySeq(len(signal))), pin.eq(signal)]

        left, valid, taken = Signal(33), Signal(), Signal(32)
        before = register(m, 32, value)
        loaded = register(m, 1, load)
        with m.If(load):
            m.d.formal += [left.eq(Mux(loaded, taken, before) + extra), valid.eq(1),
                           taken.eq(Mux(loaded, taken, before))]
        with m.Elif(step & (left == 1) & reload):
            m.d.formal += left.eq(taken + extra)
        with m.Elif(step & (left == 1)):
            m.d.formal += valid.eq(0)
        with m.Elif(step):
            m.d.formal += left.eq(left - 1)
        m.d.comb += [
            Assume(~(load & ~loaded) | (before != 0)),
            # A reload needs the value still, that is since the clock before the load.
            Assume(~reload | ((value == taken) & (before == taken))),
            Assert(~valid | (taken != 0)),
        ]
        started = register(m, 1, 1)
        steps_left(m, dut, left, valid & started)
        m.d.comb += [Cover(valid & (left == 254) & (before > 255)), Cover(dut.last & loaded)]


def distance(m, inside, behind):
    """Assert that a HighWater stands for ``behind`` steps (32 bits) behind the front."""
    high = Signal(25)
    m.d.comb += high.eq(inside._high + inside._carry - inside._borrow)
    # Just after a change it is not known yet whether the rest is zero, but no step leads to the front.
    far = (inside._low >= 124) | (inside._spare & (inside._low <= 3)) | (inside._low == 0)
    m.d.comb += [
        Assert(Cat(inside._low, high) + (inside._spare << 7) == behind),
        Assert(inside.front == (behind == 0)),
        Assert((inside._near == (high == 0)) | far),
        Assert(~inside._carry | (inside._spare & (inside._low == 0))),
        Assert(~inside._borrow | (~inside._spare & (inside._low == 127))),
        Assert(~(inside._carry & inside._borrow)),
    ]


class HighWaterKnowsTheFront(Proof):
    """Any steps: ``front`` exactly when nothing of the way is repeated, up to 2**32 - 1 steps behind."""

    block = "rtl.divider"
    depth = 5
    cover_depth = 12
    bug_depth = 8
    widths = "distance 32"
    bugs = {
        "a step back is forgotten at once": ("spare.eq(spare | low.all()), self.front.eq(0)",
                                             "spare.eq(spare | low.all()), self.front.eq(self.front)"),
        "the front is announced a step early": ("near & ~spare & (low == 1)", "near & ~spare & (low <= 2)"),
        "standing behind is taken for the front": ("self.forward & ~self.front\n", "~self.backward & ~self.front\n"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.HighWater(), "fast")
        active, forward, backward = Signal(), Signal(), Signal()
        m.d.comb += [active.eq(AnySeq(1)), forward.eq(AnySeq(1)), backward.eq(AnySeq(1)),
                     dut.active.eq(active), dut.forward.eq(forward), dut.backward.eq(backward)]
        behind = Signal(32)
        with m.If(~active):
            m.d.formal += behind.eq(0)
        with m.Elif(backward):
            m.d.formal += behind.eq(behind + 1)
        with m.Elif(forward & (behind != 0)):
            m.d.formal += behind.eq(behind - 1)
        m.d.comb += [Assume(~(forward & backward)), Assume(~backward | ~behind.all())]
        distance(m, dut, behind)
        m.d.comb += [Cover((behind == 2) & register(m, 1, behind == 3)),
                     Cover((behind == 0) & active & register(m, 1, behind == 1))]


class PixelsFollowTheRecurrence(Proof):
    """Any line, any steps: pixel k exactly when progress first comes to floor(S), S <- S + N from S = phi."""

    block = "rtl.divider"
    depth = 3
    cover_depth = 16
    bug_depth = 14
    widths = "N 32.32, phase 32, pixels 32, progress 32, sum 64"
    fast = False            # two minutes, most of it for the claim; the random lines of tb/rtl are quicker
    bugs = {
        "the carry is lost": ("edges.extra.eq(extra)", "edges.extra.eq(0)"),
        "the carry comes a pixel late at full rate": ("following.eq(Mux(advance, carry, after))",
                                                      "following.eq(after)"),
        "the phase is ignored": ("Mux(self.arm, self.settings.phase, self.settings.fraction)", "self.settings.fraction"),
        "ground regained counts again": ("forward & high_water.front & self.active &", "forward & self.active &"),
        "a pixel too many": ("self.done.eq(complete & pixels.last)", "self.done.eq(complete & ~pixels.last)"),
        "the place of the next pixel is reported": ("progress_count.eq(count)", "progress_count.eq(self.step.count)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.PixelDivider(), "fast")
        arm, active = Signal(), Signal()
        whole, fraction, phase, pixels = (Signal(32) for _ in range(4))
        reverse, emit = Signal(), Signal()
        jump = register(m, 1, arm)
        moved, up, _, count = stepping(m, jump)
        settings = Cat(whole, fraction, phase, pixels, reverse, emit)
        m.d.comb += [arm.eq(AnySeq(1)), active.eq(AnySeq(1)), settings.eq(AnySeq(len(settings)))]
        for name, value in (("whole", whole), ("fraction", fraction), ("phase", phase), ("pixels", pixels),
                            ("reverse", reverse), ("emit", emit)):
            m.d.comb += getattr(dut.settings, name).eq(value)
        m.d.comb += [dut.arm.eq(arm), dut.active.eq(active), dut.step.moved.eq(moved), dut.step.up.eq(up),
                     dut.step.count.eq(count)]

        # The user's side: settings that can work, still since the arming; a gate that opens 4 steps after it or
        # later, and closes 2 steps after the last pixel at the latest.
        age, finished, closing = Signal(3, name="age"), Signal(), Signal()
        settled, loaded = Signal(), Signal()
        m.d.formal += [age.eq(Mux(arm, 1, Mux((age == 0) | loaded, age, age + 1))), closing.eq(finished & ~arm)]
        m.d.comb += [
            settled.eq(age >= 4), loaded.eq(age == 5),
            Assume(arm | (settings == register(m, len(settings), settings))),
            Assume(~arm | (age == 0) | settled),
            Assume(~active | (settled & ~closing)),
            Assume((whole != 0) & (pixels != 0)),
        ]

        # Steps as the divider sees them, a step later; how far the stage is behind its best.
        along, against = Signal(), Signal()
        m.d.formal += [along.eq(moved & Mux(reverse, ~up, up)), against.eq(moved & Mux(reverse, up, ~up))]
        here = register(m, signed(32), count)
        behind = Signal(32)
        with m.If(~active):
            m.d.formal += behind.eq(0)
        with m.Elif(against):
            m.d.formal += behind.eq(behind + 1)
        with m.Elif(along & (behind != 0)):
            m.d.formal += behind.eq(behind - 1)
        m.d.comb += Assume(~against | ~behind.all())

        # The recurrence, in one number of 64 bits, a step later again.  ``due`` is where the next pixel is.
        step, due, progress, wanted = Signal(64), Signal(64), Signal(32), Signal(32)
        done_pixels, end = Signal(32), Signal(signed(32))
        forward, complete, last, there = Signal(), Signal(), Signal(), Signal(signed(32))
        m.d.comb += [
            step.eq(Cat(fraction, whole)),
            forward.eq(register(m, 1, along & active & (behind == 0) & ~arm)), there.eq(register(m, signed(32), here)),
            complete.eq(forward & ~finished & ((progress + 1)[:32] == due[32:])),
            wanted.eq(Mux(arm, register(m, 32, pixels), pixels)),       # the line before counts to its own end
            last.eq(complete & (done_pixels == wanted - 1)),
        ]
        with m.If(forward):
            m.d.formal += progress.eq(progress + 1)
        with m.If(complete):
            m.d.formal += [due.eq(due + step), done_pixels.eq(done_pixels + 1), end.eq(there), finished.eq(last)]
        with m.If(arm):
            m.d.formal += [progress.eq(0), due.eq(phase + step), done_pixels.eq(0), end.eq(0), finished.eq(0)]

        # Results a step after the strobes, and still those of the line before in the step after an arming.
        ready = age > 1
        m.d.comb += [
            Assert(dut.pixel == register(m, 1, complete & emit)), Assert(dut.done == register(m, 1, last)),
        ]
        shown, shown_end = register(m, 32, done_pixels), register(m, signed(32), end)
        m.d.comb += [
            Assert(~ready | (dut.produced == shown)), Assert(~ready | (dut.end_position == shown_end)),
        ]

        # What induction needs to know of the inside.
        distance(m, dut._high_water, behind)
        left, pixels_left = Signal(33), Signal(32)
        edges_left = (due[32:] - progress)[:32]         # 0 stands for 2**32, when N is nearly that
        m.d.comb += [left.eq(Cat(edges_left, edges_left == 0)), pixels_left.eq(wanted - done_pixels)]
        steps_left(m, dut._edges, left, loaded & ~finished)
        steps_left(m, dut._pixels, pixels_left, settled & ~finished)
        f = [due[:32]]
        carries = [None]
        for n in range(3):
            total = Signal(33, name=f"fraction{n}")
            m.d.comb += total.eq(f[-1] + fraction)
            f.append(total[:32])
            carries.append(total[32])
        first = Signal(33)
        m.d.comb += first.eq(phase + fraction)
        m.d.comb += [
            Assert(dut._primed == Cat(age == n for n in range(1, 5))), Assert(dut._progress == forward),
            Assert(~forward | loaded), Assert(arm | (age == 0) | loaded | dut._advance),
            Assert(arm | (age < 2) | (dut._addend == fraction)),
            Assert((age != 1) | ((dut._addend == phase) & (dut._fraction == 0))),
            Assert(arm | (age != 2) | (dut._fraction == phase)),
            Assert(arm | (age != 3) | (Cat(dut._fraction, dut._carry) == first)),
            Assert(arm | (age != 4) | ((dut._extra == first[32]) & (dut._fraction == f[1])
                                       & (dut._carry == carries[1]))),
            Assert(arm | ~loaded | (dut._extra == carries[1])),
            Assert(arm | ~loaded | Mux(dut._advance, (dut._carry == carries[2]) & (dut._fraction == f[2]),
                                  (dut._after == carries[2]) & (dut._carry == carries[3])
                                  & (dut._fraction == f[3]))),
            Assert(arm | (age < 2) | ((dut._edges._start == whole) & (dut._pixels._start == pixels))),
            Assert(~finished | ~dut._edges.last), Assert(~finished | settled), Assert(age <= 5),
            Assert(~settled | finished | (pixels_left != 0)),
            Assert(arm | settled | (age == 0)
                   | ((progress == 0) & (done_pixels == 0) & (due == (phase + step)[:64]))),
            Assert(settled | (behind == 0) | (age == 1)),
        ]
        m.d.comb += [
            Cover((dut.produced == 3) & (fraction == 0x80000000) & (whole == 1) & dut.done),
            Cover((dut.produced == 1) & reverse & (behind == 2)),
        ]
