# SPDX-License-Identifier: BSD-2-Clause
"""The lamp's modulation: every period is whole, whatever is set and whenever."""

from amaranth import Mux, Signal

from tb.formal.divider import register, steps_left
from tb.formal.proof import AnySeq, Assert, Assume, Cover, Proof, one_clock


class EveryPeriodIsHighOnceForItsShare(Proof):
    """Any settings, new in every clock: a period has the length and the high clocks that were set 3 clocks before it,
    the high ones first and without a break; 0 is never high, and the whole period never low. Only a dark period may be
    shorter: it ends when light is set."""

    block = "rtl.led"
    depth = 5
    cover_depth = 24
    bug_depth = 20
    widths = "period 21, high part 21"
    bugs = {
        "settings are taken in mid-period": ("with m.If(lead[0]):", "with m.If(~lead[-1]):"),
        "no period follows": ("lead.eq((lead << 1) | end)", "lead.eq(lead << 1)"),
        "the length is that of a clock later": ("period.value.eq(present.rest)", "period.value.eq(self.settings.rest)"),
        "the high part begins a clock early": ("pulse.trigger.eq(lead[-1] & present.lit)",
                                               "pulse.trigger.eq(lead[-2] & present.lit)"),
        "a lit period ends early": ("~present.lit & self.settings.lit", "self.settings.lit"),
        "a period ends twice": (" & (lead == 0)", ""),
        "dark is a clock of light": ("lead[-1] & present.lit", "lead[-1]"),
        "the length is taken, the high part is not": ("pulse.width.eq(present.on)", "pulse.width.eq(self.settings.on)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.LedPwm(), "fast")
        bits = block.LENGTH_BITS
        rest, on = Signal(bits), Signal(bits)
        m.d.comb += [
            rest.eq(AnySeq(bits)), on.eq(AnySeq(bits)), Assume((rest != 0) & (rest < (1 << bits) - 3) & (on <= rest + 3)),
            dut.settings.rest.eq(rest), dut.settings.on.eq(on), dut.settings.lit.eq(on != 0),
        ]

        # The present period, by what is left of it, this clock among that; and the one to come. It begins with the
        # last three clocks of a dark one.
        left, high = Signal(bits, init=3), Signal(bits)
        next_rest, next_on, dark = Signal(bits), Signal(bits), Signal(init=1)
        with m.If(left == 3):
            m.d.formal += [next_rest.eq(rest), next_on.eq(on)]
        with m.If(left == 1):
            m.d.formal += [left.eq(next_rest + 3), dark.eq(next_on == 0)]
        with m.Else():
            m.d.formal += left.eq(Mux((left > 3) & dark & (on != 0), 3, left - 1))
        m.d.formal += high.eq(Mux(left == 1, next_on, high - (high != 0)))
        m.d.comb += Assert(dut.level == (high != 0))

        # What induction needs to know of the inside.
        present, lead = dut._present, dut._lead
        period, pulse = dut._period, dut._pulse._countdown
        m.d.comb += self.lemmas(
            lead[0] == (left == 3), lead[1] == (left == 2), lead[2] == (left == 1), left != 0, high <= left,
            (left >= 3) | ((present.rest == next_rest) & (present.on == next_on)),
            present.lit == (present.on != 0), ~dark | (high == 0), (left < 3) | (dark == ~present.lit), (present.rest != 0) | (left == 3),
            (left == 2) | (period._start == present.rest) | ~register(m, 1, 1), (left == 2) | (pulse._start == present.on),
            next_rest + 3 >= next_on, next_rest <= (1 << bits) - 4,
        )
        if self._with_lemmas:
            counting = Signal(33)
            m.d.comb += counting.eq(left - 3)
            steps_left(m, period, counting, left > 3)
            steps_left(m, pulse, high, high != 0)
        m.d.comb += [
            Cover((high == 2) & (left == 5)), Cover((left == 1) & (high == 1) & (next_on == 0)),
            Cover((left == 1) & (high == 1) & (next_on == 2) & (next_rest == 9)),
        ]
