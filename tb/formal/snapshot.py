# SPDX-License-Identifier: BSD-2-Clause
"""The timestamp is a 64-bit count of clocks, although no carry runs through 64 bits."""

from amaranth import Signal

from tb.formal.proof import Assert, Cover, Proof, one_clock


class TimeRisesByOne(Proof):
    """From a start a few clocks before the low word wraps, and inductively from any time."""

    block = "rtl.snapshot"
    depth = 3
    cover_depth = bug_depth = 8
    widths = "time 64"
    bugs = {
        "the high word rises a clock late": ("low == LAST - 1", "low == LAST"),
        "no carry at reset": ("init=init & LAST == LAST", "init=0"),
    }
    START = (6 << 32) - 1

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Timestamp(init=self.START), "fast")
        time = Signal(64, init=self.START)
        m.d.formal += time.eq(time + 1)
        m.submodules.early = early = one_clock(block.Timestamp(init=self.START - 3), "fast")
        m.d.comb += [
            Assert(dut.time == time), Assert(early.time == (time - 3)[:64]),
            *self.lemmas(*(t._carry == (t.time[:32] == 0xffff_ffff) for t in (dut, early))),
            Cover(early.time == (6 << 32) + 1),
        ]
