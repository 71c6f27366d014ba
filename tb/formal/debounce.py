# SPDX-License-Identifier: BSD-2-Clause
"""What is debounced changes once: its edges are as far apart as it says, and no bounce gets through."""

from amaranth import Mux, Signal

from tb.formal.proof import AnyConst, AnySeq, Assert, Cover, Proof, one_clock


class DebouncedEdgesAreApart(Proof):
    """For every input, strobe and length of a bounce: an edge comes only after its level has lasted so many strobes
    without a break since the edge before; so edges are that many strobes apart, and none is double."""

    block = "rtl.debounce"
    depth = 3
    cover_depth = bug_depth = 14
    widths = "periods 8"
    WIDTH = 8
    bugs = {
        "a bounce does not start it anew": ("self.i == self.o", "0"),
        "a strobe early": ("seen + 1 >= self.periods", "seen + 2 >= self.periods"),
        "the strobes seen are kept": ("self.o.eq(self.i), seen.eq(0)", "self.o.eq(self.i)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.Debounce(width=self.WIDTH), "sync")
        periods = AnyConst(self.WIDTH)
        m.d.comb += [dut.i.eq(AnySeq(1)), dut.strobe.eq(AnySeq(1)), dut.periods.eq(periods)]

        # Strobes that the input has been other than the output without a break: up to the clock before, and to now.
        before, now, needed = Signal(9), Signal(9), Mux(periods == 0, 1, periods)
        change = dut.strobe & (now >= needed)
        m.d.comb += now.eq(Mux(dut.i == dut.o, 0, before + dut.strobe))
        m.d.formal += before.eq(Mux(change, 0, now))

        # The output and the input of the clock before, and what the output was to do.
        shown, level, due, edges = Signal(), Signal(), Signal(), Signal(2)
        edge = dut.o != shown
        m.d.formal += [shown.eq(dut.o), level.eq(dut.i), due.eq(change)]
        with m.If(edge & (edges < 3)):
            m.d.formal += edges.eq(edges + 1)
        m.d.comb += [
            Assert(edge == due), Assert(~edge | (dut.o == level)),
            *self.lemmas(dut._seen == before, before < needed),
            Cover((edges == 2) & edge & (periods == 3)), Cover(before == 6),
        ]
