# SPDX-License-Identifier: BSD-2-Clause
"""Quadrature decoder: encoder pins to a stream of steps, and its registers."""

from amaranth import Cat, Module, Mux, Signal, signed
from amaranth.lib import data, wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.crossing import Handover, Hold, StrobeCrossing
from rtl.filter import GlitchFilter
from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["DECODER_LATENCY", "FILTER_BITS", "DecoderSettings", "QuadratureDecoder", "QuadraturePeripheral",
           "StepStream"]

DECODER_LATENCY = 3
"""``fast`` clocks from the clock that samples a pin to the clock that shows the step; a filter adds its own."""

FILTER_BITS = 4
"""Bits of the glitch filter's setting: 0 (off) to 15 samples."""

LOW_BITS = 12
"""Bits of the count's lower part: few, to be compared quickly, and enough for the upper part to be short."""


class StepStream(wiring.Signature):
    """Steps of one axis, one per clock at most, all members aligned.  Domain ``fast``.

    Members
    -------
    moved : Out(1)
        Strobe: an edge was crossed; ``count`` is new as of this clock.
    up : Out(1)
        With ``moved``: 1 when ``count`` rose by one, 0 when it fell by one.  Otherwise meaningless.
    count : Out(signed(width))
        Position in counts, after the step.  Wraps.
    a : Out(1)
        Level of channel A, filtered, as of this ``count``; not affected by the polarity.

    Edge ``e`` lies between counts ``e - 1`` and ``e``: crossed upward it makes ``e``, downward ``e - 1``.
    """

    def __init__(self, width=32):
        super().__init__({"moved": Out(1), "up": Out(1), "count": Out(signed(width)), "a": Out(1)})


DecoderSettings = data.StructLayout({"filter": FILTER_BITS, "invert": 1})
"""``filter``: samples, 0 is off.  ``invert``: 1 exchanges the two directions."""


class QuadratureDecoder(wiring.Component):
    """Count every edge of a quadrature pair, and latch the count at the index.

    Domain ``fast``.  The step of an edge that clock 0 samples is on ``steps`` after clock 3, that is
    :data:`DECODER_LATENCY` clocks later (2 synchroniser, of which the first samples; 1 step; 1 count), plus
    exactly ``settings.filter``.  A synchroniser that resolves late adds one.  One edge per clock is counted;
    two in one clock are an error.

    Levels found at reset are taken as they are: no step, no error and no index in the first 4 clocks.

    Parameters
    ----------
    width : int
        Bits of the count, at least 2; otherwise :exc:`ValueError`.

    Members
    -------
    a, b, z : In(1)
        Encoder pins, asynchronous.  The count rises when A leads B.
    settings : In(DecoderSettings)
        A new filter is taken in a clock in which no pin has a change of level on its way, for all three at once,
        so that no two edges change places; ``invert`` is taken at once.  Neither makes or loses a count.
    steps : Out(StepStream(width))
        ``count`` is 0 at reset and wraps.
    filter : Out(4)
        In use: how much later than without filter the step comes of an edge that the synchronisers show in this clock.
    error : Out(1)
        One-clock strobe aligned with ``steps``: A and B changed in one clock, so that two counts were lost or
        none.  ``count`` stays; ``steps.a`` follows.
    errors : Out(16)
        Strobes of ``error`` up to the clock before.  Stays at 65535.
    index : Out(1)
        One-clock strobe aligned with ``steps``: Z rose.
    index_count : Out(signed(width))
        ``steps.count`` at the last ``index``, one clock later.  0 at reset.
    """

    def __init__(self, *, width=32):
        if not isinstance(width, int) or width < 2:
            raise ValueError(f"the count needs at least 2 bits, not {width!r}")
        self._filters = [GlitchFilter(bits=FILTER_BITS) for _ in "abz"]
        # Of the filters: wanted, and in use while a pin moves; and whether these are 0.
        self._wanted, self._wanted_off = Signal(FILTER_BITS), Signal(init=1)
        self._samples, self._samples_off = Signal(FILTER_BITS), Signal(init=1)
        # Looked up as their counters change: the errors are at their last value; the lower part of the count is 0,
        # or is all ones, so that the upper part moves with it downward, or upward.
        self._errors_full, self._low_zero, self._low_ones = Signal(), Signal(init=1), Signal()
        super().__init__({
            "a": In(1), "b": In(1), "z": In(1), "settings": In(DecoderSettings),
            "steps": Out(StepStream(width)), "filter": Out(FILTER_BITS), "error": Out(1), "errors": Out(16),
            "index": Out(1), "index_count": Out(signed(width)),
        })

    def elaborate(self, platform):
        m = Module()

        # Until the synchronisers have seen the pins (one clock more when late), levels are loaded unjudged.
        settling = Signal(4, init=0b1111)
        m.d.fast += settling.eq(settling >> 1)

        a, b, z = self._filters
        samples, off, still = Signal(FILTER_BITS), Signal(), Signal()
        m.d.comb += [
            still.eq((a.still & b.still & z.still) | settling[0]),
            samples.eq(Mux(still, self._wanted, self._samples)),
            off.eq(Mux(still, self._wanted_off, self._samples_off)),
            self.filter.eq(self._samples),
        ]
        m.d.fast += [
            self._wanted.eq(self.settings.filter), self._wanted_off.eq(self.settings.filter == 0),
            self._samples.eq(samples), self._samples_off.eq(off),
        ]
        for name, pin, level in ("a", self.a, a), ("b", self.b, b), ("z", self.z, z):
            m.submodules[f"{name}_sync"] = FFSynchronizer(pin, level.i, o_domain="fast")
            m.submodules[f"{name}_filter"] = level
            m.d.comb += [level.samples.eq(samples), level.off.eq(off), level.load.eq(settling[1])]

        # Judged together with the filters' change of level.  Upward exactly when the new level of A differs
        # from the old level of B; only the case of a single change is used.
        moved, down, illegal, index = Signal(), Signal(), Signal(), Signal()
        m.d.fast += [
            moved.eq((a.change ^ b.change) & ~settling[0]),
            down.eq(~(a.next ^ b.level ^ self.settings.invert)),
            illegal.eq(a.change & b.change & ~settling[0]),
            index.eq(z.next & ~z.level & ~settling[0]),
        ]

        # Two parts, each a carry chain of its own.  The step, 1 or -1, is registered as the chains want it.
        count, low_zero, low_ones = self.steps.count, self._low_zero, self._low_ones
        low_bits = min(LOW_BITS, len(count) // 2)
        low, high = count[:low_bits], count[low_bits:]
        with m.If(moved):
            m.d.fast += [
                low.eq(low + Cat(1, down.replicate(len(low) - 1))),
                low_zero.eq(Mux(down, low == 1, low_ones)), low_ones.eq(Mux(down, low_zero, ~low == 1)),
            ]
        with m.If(moved & Mux(down, low_zero, low_ones)):
            m.d.fast += high.eq(high + Cat(1, down.replicate(len(high) - 1)))
        m.d.fast += [
            self.steps.moved.eq(moved), self.steps.up.eq(~down), self.steps.a.eq(a.level),
            self.error.eq(illegal), self.index.eq(index),
        ]

        full = self._errors_full
        another = self.error & ~full
        with m.If(another):
            m.d.fast += self.errors.eq(self.errors + 1)
        m.d.fast += full.eq(self.errors[1:].all() & (self.errors[0] | another))
        with m.If(self.index):
            m.d.fast += self.index_count.eq(count)
        return m


class QuadraturePeripheral(wiring.Component):
    """One encoder axis on the register bus.  Registers are the nested classes, in address order.

    Registers in ``sync``, the decoder in ``fast``.  The live position is not a register: the snapshot block
    latches all axes on one clock.

    Members
    -------
    a, b, z : In(1)
        Encoder pins, asynchronous.
    steps : Out(StepStream), fast
    filter : Out(4), fast
        As of the decoder.
    sample : In(1), fast
        The snapshot's sample strobe: ``Errors`` and ``IndexPosition`` are latched at the end of this clock.
    error : Out(1), sync
        Strobe with which ``Status.error`` is set: one for an illegal transition, or for some close to each other.
    """

    class Config(Register, access="rw"):
        """How the pins are read.  Taken over within 6 ``sync`` clocks of the write, the filter when all pins stand
        still as well."""
        filter: Field(action.RW, FILTER_BITS, unit="fast clocks",
                      doc="A level is believed after this many further identical samples; 0 is off. "
                          "Delays every edge by as many clocks.")
        invert: Field(action.RW, 1, doc="Exchanges the directions: count up when B leads A.")

    class Status(Register, access="rw"):
        """What happened since it was last cleared."""
        error: Field(action.RW1C, 1, doc="A and B changed in one clock: the position is no longer certain. "
                                         "Write 1 to clear.")
        index: Field(action.RW1C, 1, doc="The index passed. Write 1 to clear.")

    class Errors(Register, access="r"):
        """Illegal transitions since reset, as of the snapshot's last sample."""
        value: Field(action.R, 16, doc="Stays at 65535.")

    class IndexPosition(Register, access="r"):
        """Position at the last rising edge of the index, as of the snapshot's last sample."""
        value: Field(action.R, signed(32), unit="counts", doc="Latched by hardware on the edge itself.")

    def __init__(self):
        self._registers = RegisterBank(addr_width=2)
        self._config = self._registers.add(self.Config, offset=0x0)
        self._status = self._registers.add(self.Status, offset=0x4)
        self._errors = self._registers.add(self.Errors, offset=0x8)
        self._index = self._registers.add(self.IndexPosition, offset=0xc)
        memory_map = self._registers.finish()
        super().__init__({
            "bus": In(self._registers.bus_signature), "a": In(1), "b": In(1), "z": In(1),
            "steps": Out(StepStream()), "filter": Out(FILTER_BITS), "sample": In(1), "error": Out(1),
        })
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.decoder = decoder = QuadratureDecoder()
        connect(m, flipped(self.bus), self._registers.bus)
        connect(m, decoder.steps, flipped(self.steps))
        m.d.comb += [
            decoder.a.eq(self.a), decoder.b.eq(self.b), decoder.z.eq(self.z), self.filter.eq(decoder.filter),
        ]

        # The register holds what was written one clock after the write strobe.
        m.submodules.settings = settings = Handover(DecoderSettings, source="sync", destination="fast")
        m.d.sync += settings.request.eq(self._config.element.w_stb)
        m.d.comb += [
            settings.payload.filter.eq(self._config.f.filter.data),
            settings.payload.invert.eq(self._config.f.invert.data),
            decoder.settings.eq(settings.o),
        ]

        for name, strobe in ("error", decoder.error), ("index", decoder.index):
            crossing = StrobeCrossing(source="fast", destination="sync")
            m.submodules[f"{name}_crossing"] = crossing
            m.d.comb += [crossing.i.eq(strobe), getattr(self._status.f, name).set.eq(crossing.o)]
        m.d.comb += self.error.eq(m.submodules.error_crossing.o)

        for name, value, register in (("errors", decoder.errors, self._errors),
                                      ("index", decoder.index_count, self._index)):
            hold = Hold(value.shape(), domain="fast")
            m.submodules[f"{name}_hold"] = hold
            m.d.comb += [hold.i.eq(value), hold.take.eq(self.sample), register.f.value.r_data.eq(hold.o)]
        return m
