# SPDX-License-Identifier: BSD-2-Clause
"""The decoder counts exactly the legal edges, with and without filter.

The reference shares no formula with the block: it looks up places on the quadrature circle, and finds the level
that the filter believes in a shift register of the last samples.
"""

from amaranth import Array, Cat, Const, Mux, Signal, signed

from tb.formal.proof import AnyConst, AnySeq, Assert, Cover, Proof, one_clock

QUARTER = Array(Const(q, 2) for q in (0, 1, 3, 2))
"""Quarter of the circle for the number ``2 * b + a``: going up, A rises first."""


def delayed(m, value, clocks):
    """The value as it was ``clocks`` steps ago; 0 before the first."""
    for n in range(clocks):
        later = Signal(value.shape(), name=f"delayed{n}")
        m.d.formal += later.eq(value)
        value = later
    return value


def believed(m, sample, samples, loading):
    """The level believed one step after ``sample``: the last that filled a window of ``samples + 1``.

    Returns it with the number of samples, up to the one before ``sample``, that have differed from it in a row.
    """
    level, earlier, run = Signal(), Signal(15), Signal(4)
    window, mask = Signal(16), Signal(16)
    m.d.comb += [window.eq(Cat(sample, earlier)), mask.eq((2 << samples) - 1)]
    m.d.formal += earlier.eq(window)
    with m.If(loading):
        m.d.formal += level.eq(sample)
    with m.Elif((window & mask) == mask):
        m.d.formal += level.eq(1)
    with m.Elif((window & mask) == 0):
        m.d.formal += level.eq(0)
    for n in range(16):
        with m.If((earlier ^ level.replicate(15))[:n].all()):
            m.d.comb += run.eq(n)
    return level, run


class CountsEveryEdge(Proof):
    """Without filter: count, steps, errors and index follow the pins, whatever the pins do, for ever."""

    block = "rtl.quadrature"
    depth = 6
    cover_depth = 14
    bug_depth = 14
    widths = "count 32, errors 16, polarity any, filter off"
    bugs = {
        "an illegal transition counts": ("(a.change ^ b.change)", "(a.change | b.change)"),
        "the direction is that of the old level": ("down.eq(~(a.next ^", "down.eq(~(a.level ^"),
        "the polarity is ignored": (" ^ self.settings.invert", ""),
        "the index is taken at the falling edge": ("z.next & ~z.level", "~z.next & z.level"),
        "the upper part is not borrowed from": ("Mux(down, low_zero, low_ones))", "low_ones)"),
        "the upper part is borrowed from a step early": ("Mux(down, low == 1,", "Mux(down, low == 2,"),
        "the upper part is carried to a step early": ("~low == 1", "~low == 2"),
        "the levels at reset make a step": ("(a.change ^ b.change) & ~settling[0]", "a.change ^ b.change"),
    }

    def samples(self):
        return Const(0, 4)

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.QuadratureDecoder(), "fast")
        pins, samples, invert = Signal(3), Signal(4), Signal()
        m.d.comb += [
            pins.eq(AnySeq(3)), samples.eq(self.samples()), invert.eq(AnyConst(1)),
            Cat(dut.a, dut.b, dut.z).eq(pins),
            dut.settings.filter.eq(samples), dut.settings.invert.eq(invert),
        ]

        # Levels 3 steps after the pins; in the first 4 they are loaded, so a change counts from step 5.
        start = Signal(3)
        m.d.formal += start.eq(Mux(start >= 5, 5, start + 1))
        sampled = delayed(m, pins, 2)
        (a, _), (b, _), (z, _) = believes = [believed(m, sampled[n], samples, start < 4) for n in range(3)]
        old_a, old_b, old_z = (delayed(m, level, 1) for level in (a, b, z))
        quarters = Signal(2)
        m.d.comb += quarters.eq(Mux(start == 5, QUARTER[Cat(a, b)] - QUARTER[Cat(old_a, old_b)], 0))

        forward = Mux(invert, 3, 1)
        count, moved, up, error, rose = Signal(signed(32)), Signal(), Signal(), Signal(), Signal()
        m.d.formal += [
            moved.eq(quarters[0]), up.eq(quarters == forward), error.eq(quarters == 2),
            rose.eq((start == 5) & z & ~old_z),
        ]
        with m.If(quarters[0]):
            m.d.formal += count.eq(Mux(quarters == forward, count + 1, count - 1))
        errors, index_count = Signal(16), Signal(signed(32))
        with m.If(error & (errors < 65535)):
            m.d.formal += errors.eq(errors + 1)
        with m.If(rose):
            m.d.formal += index_count.eq(count)

        m.d.comb += [
            Assert(dut.steps.count == count), Assert(dut.steps.moved == moved), Assert(dut.steps.a == old_a),
            Assert(~moved | (dut.steps.up == up)), Assert(dut.error == error), Assert(dut.errors == errors),
            Assert(dut.index == rose), Assert(dut.index_count == index_count),
        ]
        # What induction needs to know of the inside: the filters' levels, and what they still wait for.
        m.d.comb += self.lemmas(
            dut._wanted_off == (dut._wanted == 0), dut._samples_off == (dut._samples == 0),
            (start == 0) | (dut._wanted == samples), (start < 2) | (dut._samples == samples),
            dut._errors_full == (errors == 65535),
            dut._low_zero == (count[:12] == 0), dut._low_ones == (count[:12] == 0xfff))
        for (level, run), inside in zip(believes, dut._filters):
            m.d.comb += self.lemmas(
                inside.level == level,
                (start < 2) | ((run <= samples) & (inside._missing == (samples - run)[:4])),
                inside._ready == ((inside._missing == 0) | (start < 4)))
        m.d.comb += [
            Cover((count == 3) & invert), Cover((count == -2) & (errors == 1)), Cover((index_count == 2) & ~z),
        ]


class CountsEveryFilteredEdge(CountsEveryEdge):
    """The same with the filter at any constant setting: it hides short pulses and delays the others."""

    depth = 8
    cover_depth = 16
    bug_depth = 16
    widths = "count 32, errors 16, polarity any, filter any of 0..15"
    bugs = {
        "the setting is ignored": ("level.samples.eq(samples)", "level.samples.eq(0)"),
        "it is not known to be off": ("level.off.eq(off)", "level.off.eq(0)"),
    }

    def samples(self):
        return AnyConst(4)
