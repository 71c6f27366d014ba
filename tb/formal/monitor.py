# SPDX-License-Identifier: BSD-2-Clause
"""The interlock's detectors find what they say, in time, and nothing else; whatever drive, counts and limits do."""

from amaranth import Mux, Signal, signed

from tb.formal.divider import register
from tb.formal.proof import AnyConst, AnySeq, Assert, Assume, Cover, Proof, one_clock


def anything(m, *pins):
    """Give each pin any value in every clock."""
    for pin in pins:
        pin = pin if isinstance(pin, Signal) else pin.as_value()
        m.d.comb += pin.eq(AnySeq(len(pin)))


class NoWayIsFound(Proof):
    """Any drives, steps, samples and limits: a fault when and only when the counts since way was last made lie closer
    together than way, and the excess has been large, of one sign, for so many samples."""

    block = "rtl.monitor"
    depth = 3
    cover_depth = bug_depth = 9
    widths = "steps 8, drive 13, times 16"
    bugs = {
        "way is net": ("high - low >= limits.way", "(at >= limits.way) | (at <= -limits.way)"),
        "way does not begin anew": ("old.eq(Mux(made, 0, new))", "old.eq(new)"),
        "a change of direction is no change": (" | (forward != self._forward)", ""),
        "the time goes on below the drive": ("made | ~counts | (forward", "made | (forward"),
        "a sample late": ("(self._strong_for > limits.strong_samples)",
                          "(self._strong_for > limits.strong_samples + 1)"),
        "held is not": ("Mux(self.hold, self._reference, 0)", "0"),
        "strong drive does not hold": (" & ~holds", ""),
        "the reference is the drive": ("self._mean >> MEAN_BITS)\n        with", "self.drive)\n        with"),
        "the reference follows the drive": ("with m.If(made):\n                m.d.sync += self._reference",
                                            "with m.If(~made):\n                m.d.sync += self._reference"),
        "breakaway of an axis that holds": ("Mux(holds, limits.held, limits.breakaway)", "limits.breakaway"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Progress(), "sync")
        anything(m, dut.stb, dut.window, dut.step, dut.drive, dut.hold)
        limits = dut.limits
        for name in "way", "strong", "strong_samples", "breakaway", "held", "samples":
            pin = getattr(limits, name)
            m.d.comb += pin.eq(AnyConst(len(pin)))

        # Where the count is, from where it was when way was last made; and all that it has been at since.
        place, lowest, highest = (Signal(signed(12), name=n) for n in ("place", "lowest", "highest"))
        now, least, most = (Signal(signed(12), name=n) for n in ("now", "least", "most"))
        drive, hold = register(m, signed(13), dut.drive), register(m, 1, dut.hold)
        last, mean = Signal(signed(13)), Signal(signed(13 + block.MEAN_BITS))   # at the last way; times 64
        whole = mean >> block.MEAN_BITS
        held = register(m, signed(13), last)
        excess, size = Signal(signed(15)), Signal(15)
        m.d.comb += [
            now.eq(place + dut.step),
            least.eq(Mux(now < lowest, now, lowest)), most.eq(Mux(now > highest, now, highest)),
            excess.eq(Mux(hold, drive - held, drive)), size.eq(Mux(excess[-1], 0 - excess, excess)),
        ]
        made = Signal()
        m.d.comb += made.eq(most - least >= limits.way)
        up, was_up = Signal(), Signal()
        m.d.comb += up.eq(~excess[-1] & register(m, 1, 1))
        runs = []
        for name, least_drive, time in (("strong", limits.strong, limits.strong_samples),
                                        ("weak", Mux(hold, limits.held, limits.breakaway), limits.samples)):
            run = Signal(17, name=f"{name}_run")
            runs.append((run, time))
            with m.If(dut.stb):
                with m.If(made | (size < least_drive) | (hold if name == "strong" else 0)):
                    m.d.formal += run.eq(0)
                with m.Elif(up != was_up):
                    m.d.formal += run.eq(1)
                with m.Elif(run <= time):
                    m.d.formal += run.eq(run + 1)
        with m.If(dut.stb):
            m.d.formal += [place.eq(Mux(made, 0, now)), lowest.eq(Mux(made, 0, least)), highest.eq(Mux(made, 0, most)),
                           was_up.eq(up)]
            with m.If(made):
                m.d.formal += last.eq(whole)
        with m.If(dut.window):
            m.d.formal += mean.eq(mean - whole + dut.drive)
        # The clock of reset: the drive of the clock before it was 0, but no excess had been looked at.
        m.d.comb += Assume(~dut.stb | register(m, 1, 1))
        m.d.comb += [
            Assert(dut.fault == ((runs[0][0] > runs[0][1]) | (runs[1][0] > runs[1][1]))),
            *self.lemmas(dut._at == place, dut._low == lowest, dut._high == highest, dut._reference == last, dut._mean == mean,
                         dut._strong_for == runs[0][0], dut._weak_for == runs[1][0], dut._forward == was_up,
                         (lowest <= 0) & (highest >= 0) & (highest - lowest < 15),
                         (place >= lowest) & (place <= highest)),
            Cover(dut.fault & (runs[0][0] == 4) & (highest == 1) & (place == 0) & (limits.way == 2)),
            Cover(dut.fault & (runs[1][0] == 3) & hold & (limits.held > limits.breakaway)),
        ]


class AStuckWireIsFound(Proof):
    """Counts that are one of two neighbours, whatever they do: with way of 2 or more, the drive alone says when it is a
    fault."""

    block = "rtl.monitor"
    depth = 3
    cover_depth = bug_depth = 9
    widths = "drive 13, times 16"
    bugs = {
        "one step is way": ("high - low >= limits.way", "high - low >= limits.way - 1"),
        "a step is progress": ("with m.If(made | ~counts", "with m.If(made | (self.step != 0) | ~counts"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Progress(), "sync")
        anything(m, dut.stb, dut.drive)
        upper, way, strong, time = Signal(), AnyConst(4), AnyConst(12), AnyConst(16)
        begun = register(m, 1, 1)
        turn = Signal()
        m.d.comb += [turn.eq(AnySeq(1)), dut.step.eq(Mux(turn, Mux(upper, -1, 1), 0)), Assume(~dut.stb | begun)]
        with m.If(dut.stb & turn):
            m.d.formal += upper.eq(~upper)
        m.d.comb += [
            dut.limits.way.eq(way), dut.limits.strong.eq(strong), dut.limits.strong_samples.eq(time),
            dut.limits.breakaway.eq(0xfff), dut.limits.samples.eq(0xffff), Assume(way > 1), Assume(strong != 0),
        ]
        drive = register(m, signed(13), dut.drive)
        sign = Signal(signed(2))
        m.d.comb += sign.eq(Mux(drive >= strong, 1, Mux(drive <= 0 - strong, -1, 0)))
        run, was = Signal(17), Signal(signed(2))
        with m.If(dut.stb):
            m.d.formal += [was.eq(sign), run.eq(Mux(sign == 0, 0, Mux(sign != was, 1, Mux(run > time, run, run + 1))))]
        weak = Signal()                                 # nothing is above 4095 but the most negative drive
        m.d.comb += [weak.eq(dut._weak_for > 0xffff), Assume(dut.drive > -4095)]
        m.d.comb += Assert(weak | (dut.fault == (run > time)))
        m.d.comb += [
            *self.lemmas(dut._at == Mux(upper, 1, 0), (dut._low == 0) & (dut._high < 2) & (dut._high >= dut._at),
                         (run == 0) == (was == 0), was != -2, run <= time + 1, dut._strong_for == run,
                         (run == 0) | (dut._forward == (was == 1))),
            Cover(dut.fault & (run == 4) & dut._high[0]),
        ]


class TooFastIsFound(Proof):
    """Any steps and windows: a fault in a window when and only when the one before went further than the limit."""

    block = "rtl.monitor"
    depth = 3
    cover_depth = bug_depth = 8
    widths = "steps 8, limit 16"
    bugs = {
        "only forward": ("Mux(way < 0, -way, way) > self.limit", "way > self.limit"),
        "the last step is left out": ("Mux(way < 0, -way, way)", "Mux(self._way < 0, -self._way, self._way)"),
        "windows add up": ("[self._way.eq(0), ", "[self._way.eq(way), "),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Overspeed(), "sync")
        anything(m, dut.stb, dut.window, dut.step, dut.limit)
        m.d.comb += Assume(~dut.window | dut.stb)
        # As a difference of two places; a window has at most 200 samples.
        place, began, samples = Signal(signed(32)), Signal(signed(32)), Signal(8)
        now, way = Signal(signed(32)), Signal(signed(32))
        m.d.comb += [now.eq(place + dut.step), way.eq(now - began), Assume((samples < 200) | ~dut.stb | dut.window)]
        too_fast = Signal()
        with m.If(dut.stb):
            m.d.formal += [place.eq(now), samples.eq(samples + 1)]
        with m.If(dut.window):
            m.d.formal += [began.eq(now), samples.eq(0), too_fast.eq((way > dut.limit) | (way < 0 - dut.limit))]
        most, so_far = Signal(signed(32)), Signal(signed(32))
        m.d.comb += [most.eq(samples << 7), so_far.eq(place - began)]
        m.d.comb += [
            Assert(dut.fault == too_fast),
            *self.lemmas(dut._way == so_far, samples <= 200, so_far <= most, so_far >= 0 - most),
            Cover(dut.fault & register(m, 1, way < 0)), Cover(dut.fault & (samples == 2)),
        ]


class FarIsFound(Proof):
    """Any counts, expected or not: two clocks later it is known whether they differ by more than they may, across the
    wrap too."""

    block = "rtl.monitor"
    depth = 4
    cover_depth = bug_depth = 6
    widths = "counts 32, window 31"
    bugs = {
        "only ahead": (" | (self._error < -self.most)", ""),
        "at the limit": ("self._error > self.most", "self._error >= self.most"),
        "no longer armed": ("self.armed & self._far", "self._far"), "not yet armed": ("self._was_armed & (", "("),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Following(), "sync")
        anything(m, dut.count, dut.expected, dut.most, dut.armed)
        ahead, behind = Signal(32), Signal(32)
        m.d.comb += [ahead.eq(dut.count - dut.expected), behind.eq(dut.expected - dut.count)]
        nearer = Mux(ahead[-1], behind, ahead)          # the shorter way round
        far = register(m, 1, register(m, 32, nearer) > dut.most)
        begun, was_armed = register(m, 1, register(m, 1, 1)), register(m, 1, register(m, 1, dut.armed))
        m.d.comb += [
            Assert(~begun | (dut.fault == (dut.armed & was_armed & far))), Cover(begun & dut.fault),
            Cover(begun & dut.fault & register(m, 1, register(m, 1, ahead[-1]))),
        ]


class TooManyIsFound(Proof):
    """Any events and windows: a fault when and only when there were more since the count began than are allowed."""

    block = "rtl.monitor"
    depth = 3
    cover_depth = bug_depth = 8
    widths = "events 8, windows 16"
    bugs = {
        "an event with the end is lost": ("self._events.eq(self.event)", "self._events.eq(0)"),
        "one more is allowed": ("self._events > self.most", "self._events > self.most + 1"),
        "a window too many": ("self.length - 1", "self.length"),
        
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Budget(), "sync")
        anything(m, dut.event, dut.window, dut.most)
        length = AnyConst(16)
        m.d.comb += dut.length.eq(length)
        # Windows that have ended since the count began; the first count has one window.
        windows, period, events = Signal(17), Signal(17, init=1), Signal(20)
        m.d.comb += Assume(events < 0xffff0)
        ends = Signal()
        m.d.comb += ends.eq(dut.window & (windows + 1 == period))
        with m.If(dut.window):
            m.d.formal += windows.eq(windows + 1)
        m.d.formal += events.eq(events + dut.event)
        with m.If(ends):
            m.d.formal += [windows.eq(0), period.eq(Mux(length == 0, 1 << 16, length)), events.eq(dut.event)]
        m.d.comb += [
            Assert(dut.fault == (events > dut.most)),
            *self.lemmas(dut._left == (period - 1 - windows)[:16], windows < period, period <= 1 << 16,
                         dut._events == Mux(events > 256, 256, events)),
            Cover(dut.fault & (dut.most == 2)), Cover(ends & (period == 2) & (events == 2)),
        ]
