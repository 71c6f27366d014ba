# SPDX-License-Identifier: BSD-2-Clause
"""The glitch filter believes what has lasted, and nothing else, while its setting changes at any time."""

from amaranth import Mux, Signal

from tb.formal.proof import AnySeq, Assert, Cover, Proof, one_clock
from tb.formal.divider import register


class BelievesWhatLasts(Proof):
    """A level is taken by the sample that follows ``samples`` others of its kind without a break, ``samples`` as it was
    in the last clock before them; each level taken is told, with the change, and no other is."""

    block = "rtl.filter"
    depth = 4
    cover_depth = bug_depth = 24
    widths = "setting 5, changing at any time"
    bugs = {
        "one sample too few is enough": ("(missing == 1)", "(missing == 2)"),
        "samples need not be consecutive": (
            "missing.eq(self.samples)", "missing.eq(Mux(missing == 0, self.samples, missing))"),
        "off is ignored": ("ready.eq(self.off | self.load)", "ready.eq(self.load)"),
        "the change is told where there is none": ("ready & ~self.still", "ready"),
        "the setting is taken in the middle": ("missing.eq(missing - 1)", "missing.eq(self.samples - 1)"),
        "a level is not taken at once when it is loaded": ("(missing == 1) | self.load", "(missing == 1)"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.GlitchFilter(bits=5), "fast")
        i, samples, load = Signal(), Signal(5), Signal()
        m.d.comb += [i.eq(AnySeq(1)), samples.eq(AnySeq(5)), load.eq(AnySeq(1)),
                     dut.i.eq(i), dut.samples.eq(samples), dut.off.eq(samples == 0), dut.load.eq(load)]

        # ``run``: samples before this one that differ from the level, in a row; ``wanted``: the setting before them.
        level, run, wanted, loaded = Signal(), Signal(6), Signal(5), Signal(init=1)
        due = Signal()
        m.d.comb += due.eq((i != level) & ((run >= wanted) | loaded))
        m.d.formal += loaded.eq(load)
        with m.If(due):
            m.d.formal += level.eq(i)
        with m.If((i == level) | due):
            m.d.formal += [run.eq(0), wanted.eq(samples)]
        with m.Else():
            m.d.formal += run.eq(run + 1)
        was = register(m, 1, level)
        m.d.comb += [
            Assert(dut.level == level), Assert(dut.change == due), Assert(dut.next == Mux(due, i, level)),
            Assert(dut.still == (i == level)),
            *self.lemmas((run == 0) | (run <= wanted), dut._missing == (wanted - run)[:5],
                         dut._ready == (loaded | (run == wanted))),
            Cover(level & ~was & (wanted == 3) & ~loaded), Cover(~level & was & (wanted == 0)),
        ]
