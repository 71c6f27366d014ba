# SPDX-License-Identifier: BSD-2-Clause
"""The timestamp is a 64-bit count of clocks, although no carry runs through 64 bits."""

from amaranth import Signal

from tb.formal.proof import Assert, Cover, Proof, one_clock


class TimeRisesByOne(Proof):
    """From starts at the wrap of the low word and of its half, and inductively from any time."""

    block = "rtl.snapshot"
    depth = 3
    cover_depth = bug_depth = 8
    widths = "time 64"
    bugs = {
        "the high word rises a clock late": ("low[:16] == HALF - 1", "low[:16] == HALF"),
        "the carry does not ask for the upper half": ("self._near & (low[:16]", "(low[:16]"),
        "no carry at reset": ("init=init & LAST == LAST", "init=0"),
    }
    STARTS = (6 << 32) - 1, (6 << 32) - 4, (5 << 32) + 0xfffd

    def harness(self, m, block):
        for n, start in enumerate(self.STARTS):
            m.submodules[f"dut{n or ''}"] = dut = one_clock(block.Timestamp(init=start), "fast")
            time = Signal(64, init=start, name=f"time{n}")
            m.d.formal += time.eq(time + 1)
            m.d.comb += [
                Assert(dut.time == time),
                *self.lemmas(dut._carry == (time[:32] == 0xffff_ffff), dut._near == ((time - 1)[16:32] == 0xffff)),
            ]
            m.d.comb += Cover(dut.time == start + 4)
