# SPDX-License-Identifier: BSD-2-Clause
"""Motor PWM and servo tick: the drive is what was asked for or off, and duties are taken when they should be."""

from amaranth import Mux, Signal, signed

from tb.formal.divider import register
from tb.formal.proof import AnySeq, Assert, Cover, Proof, one_clock

PERIOD = 60


class TheDriveIsWhatWasAskedForOrOff(Proof):
    """Any duties, starts, phases and faults, new in every clock: high for the first clocks of a period only, as many as the duty
    taken at its start says; low a clock after ``off``, and until a start without it; the direction changes at starts alone."""

    block = "rtl.pwm"
    depth = 3
    cover_depth = bug_depth = 8
    widths = "duty 13, phase 12, period 60"
    bugs = {
        "off is for as long as it lasts": ("m.d.sync += on_clocks.eq(0)", "m.d.sync += on_clocks.eq(on_clocks)"),
        "off comes a clock late": ("(self.phase < on_clocks) & ~self.off", "self.phase < on_clocks"),
        "duties are not clamped": ("Mux(magnitude > self._period_clocks, self._period_clocks, magnitude)", "magnitude"),
        "a clock too many": ("self.phase < on_clocks", "self.phase <= on_clocks"),
        "the direction follows the duty at once": ("self.dir.eq(direction)", "self.dir.eq(self.duty > 0)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Pwm(period_clocks=PERIOD), "sync")
        duty, phase, start, off = Signal(signed(13)), Signal(12), Signal(), Signal()
        for signal, pin in (duty, dut.duty), (phase, dut.phase), (start, dut.start), (off, dut.off):
            m.d.comb += [signal.eq(AnySeq(len(signal))), pin.eq(signal)]
        taken = Signal(signed(13))                          # the duty of this period; 0 from ``off`` on
        forward, clocks = Signal(), Signal(signed(14))
        with m.If(off):
            m.d.formal += taken.eq(0)
        with m.Elif(start):
            m.d.formal += [taken.eq(duty), forward.eq(duty >= 1)]
        m.d.comb += [
            clocks.eq(Mux(taken[-1], 0 - taken, taken)),
            Assert(dut.pwm == register(m, 1, ~off & (phase < clocks) & (phase < PERIOD))), Assert(dut.dir == register(m, 1, forward)),
            *self.lemmas(dut._on_clocks == Mux(clocks > PERIOD, PERIOD, clocks), dut._direction == forward),
            Cover(dut.pwm & dut.dir & (taken == PERIOD)), Cover(dut.pwm & ~dut.dir & (taken == -4096)),
        ]


class DutiesAreTakenAfterTheirTick(Proof):
    """Any starts, dividers and delays, new in every clock: a tick a clock after every so-many-th start; duties at the one start that
    lies ``delay`` periods behind it or, if there is none, at the next tick's; at every start while there are no ticks."""

    block = "rtl.pwm"
    depth = 4
    cover_depth = bug_depth = 12
    widths = "divider and delay 8"
    bugs = {
        "a period too many": ("left.eq(self.divider - 1)", "left.eq(self.divider)"),
        "duties are taken twice": ("m.d.sync += waiting.eq(0)", "m.d.sync += waiting.eq(waiting)"),
        "a delay that is too long takes none": ("((wait == 0) | due)", "(wait == 0)"),
        "a changed divider is taken at once": ("due = self.start & (left == 0) & (self.divider != 0)",
                                               "due = self.start & ((left == 0) | (self.divider == 1)) & (self.divider != 0)"),
        "no duties without ticks": ("(stopped | (waiting", "((waiting"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.ServoTick(), "sync")
        start, divider, delay = Signal(), Signal(8), Signal(8)
        for signal, pin in (start, dut.start), (divider, dut.divider), (delay, dut.delay):
            m.d.comb += [signal.eq(AnySeq(len(signal))), pin.eq(signal)]
        # Since the last tick: starts, of how many, and which of them takes the duties unless it was before.
        passed, period, place, taken = Signal(9), Signal(9, init=1), Signal(9), Signal(init=1)
        last, due, takes = Signal(), Signal(), Signal()
        m.d.comb += [
            last.eq(passed == period - 1), due.eq(start & last & (divider != 0)),
            takes.eq(start & ((last & (divider == 0)) | (~taken & ((place == passed + 1) | due)))),
        ]
        with m.If(due):
            m.d.formal += [passed.eq(0), period.eq(divider), place.eq(delay), taken.eq(0)]
        with m.Elif(start):
            m.d.formal += [passed.eq(passed + ~last), taken.eq(taken | takes)]
        m.d.comb += [Assert(dut.tick == register(m, 1, due)), Assert(dut.take == takes)]
        m.d.comb += self.lemmas(
            dut._left + passed + 1 == period, taken == ~dut._waiting, (period != 0) & (period < 256) & (place < 256),
            taken | (dut._wait == (place - passed - 1)[:8]), taken | (place == 0) | (place > passed), passed < period,
        )
        m.d.comb += [
            Cover(due & takes & (period == 3)), Cover(takes & (passed == 1) & (place == 2)), Cover(takes & last & ~due & taken),
        ]
