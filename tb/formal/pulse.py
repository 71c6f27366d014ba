# SPDX-License-Identifier: BSD-2-Clause
"""Pulses of a programmable length: exact, whatever triggers come and however close."""

from amaranth import Mux, Signal

from rtl.divider import WIDTH_BITS
from tb.formal.divider import register, steps_left
from tb.formal.proof import AnySeq, Assert, Assume, Cover, Proof, one_clock


class PulsesLastAsLongAsSet(Proof):
    """Any triggers, lengths and clears, new in every clock: high for the length that was set before the last trigger, counted from
    it, and at no other time; every trigger that found it high is counted."""

    block = "rtl.pulse"
    depth = 4
    cover_depth = bug_depth = 12
    widths = f"length {WIDTH_BITS}, merged 32"
    bugs = {
        "it is a clock too long": ("self.pulse & ~countdown.last", "self.pulse"),
        "a trigger in a pulse does not begin it anew": ("countdown.load.eq(self.trigger)", "countdown.load.eq(self.trigger & ~self.pulse)"),
        "a length that is set in a pulse changes it": ("countdown.step.eq(self.pulse)", "countdown.step.eq(self.pulse & (self.width != 3))"),
        "triggers are counted that make pulses of their own": ("self.trigger & self.pulse", "self.trigger"),
        "a trigger wins over a clear": ("with m.If(self.clear):", "with m.If(self.clear & ~self.trigger):"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Pulse(width=WIDTH_BITS), "fast")
        trigger, width, clear = Signal(), Signal(WIDTH_BITS), Signal()
        for signal, pin in (trigger, dut.trigger), (width, dut.width), (clear, dut.clear):
            m.d.comb += [signal.eq(AnySeq(len(signal))), pin.eq(signal)]

        # Triggers in a row all take the length of before the first.
        before, follows, taken = register(m, WIDTH_BITS, width), register(m, 1, trigger), Signal(WIDTH_BITS)
        left, merged, length = Signal(WIDTH_BITS), Signal(32), Signal(WIDTH_BITS)
        m.d.comb += [length.eq(Mux(follows, taken, before)), Assume(~trigger | (length != 0))]
        with m.If(trigger):
            m.d.formal += [left.eq(length), taken.eq(length)]
        with m.Elif(left != 0):
            m.d.formal += left.eq(left - 1)
        with m.If(clear):
            m.d.formal += merged.eq(0)
        with m.Elif(trigger & (left != 0)):
            m.d.formal += merged.eq(merged + 1)
        m.d.comb += [Assert(dut.pulse == (left != 0)), Assert(dut.merged == merged)]

        if self._with_lemmas:
            counting = Signal(33)
            m.d.comb += [counting.eq(left), Assert(~follows | (taken == dut._countdown._start))]
            steps_left(m, dut._countdown, counting, left != 0)
        m.d.comb += [
            Cover((merged == 2) & (left == 1) & ~follows), Cover((left == 300) & (taken > 300)), Cover(clear & trigger & (merged == 3)),
        ]
