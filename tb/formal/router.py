# SPDX-License-Identifier: BSD-2-Clause
"""The pin router: each pin shows its own source, two clocks later, and nothing else."""

from amaranth import Array, Signal

from tb.formal.divider import register
from tb.formal.proof import AnySeq, Assert, Cover, Proof, one_clock


class PinsShowTheirSource(Proof):
    """Any sources and routes, new in every clock: a pin is what its route chose two clocks before, inverted if it said so; codes
    without a name are low."""

    block = "rtl.router"
    depth = 3
    cover_depth = bug_depth = 6
    widths = "16 codes, three pins"
    bugs = {
        "a code without a name is high": ("with m.Case(source.value):", "with m.Case(source.value, source.value | 8):"),
        "low and high are not inverted": ("level ^ route.invert", "level ^ (route.invert & (route.source > 1))"),
        "all pins go by one route": ("route = getattr(self.routes, pin)", "route = self.routes.out0"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.PinRouter(), "fast")
        sources = [0, 1]                                    # in the order of their codes
        for name in ("sync", "pixel", "direct", "light"):
            level = Signal(name=name)
            m.d.comb += [level.eq(AnySeq(1)), getattr(dut, name).eq(level)]
            sources.append(level)
        table = Array([*sources, *[0] * (16 - len(sources))])
        for pin in ("out0", "sync_out", "encoder_out"):
            code, invert, level = Signal(4, name=f"{pin}_code"), Signal(name=f"{pin}_invert"), Signal(name=f"{pin}_chosen")
            route = getattr(dut.routes, pin)
            m.d.comb += [code.eq(AnySeq(4)), invert.eq(AnySeq(1)), route.source.eq(code), route.invert.eq(invert),
                         level.eq(table[code])]
            chosen = register(m, 1, register(m, 1, level ^ invert))
            m.d.comb += [Assert(getattr(dut, pin) == chosen), Cover(getattr(dut, pin) & ~register(m, 1, getattr(dut, pin)))]
