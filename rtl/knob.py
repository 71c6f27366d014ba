# SPDX-License-Identifier: BSD-2-Clause
"""Hand-wheels: three quadrature decoders for what a hand turns, with a filter against contacts that bounce.

Small and in the slow domain: a hand makes some thousands of edges a second where the stage's encoders, which are
:mod:`rtl.quadrature`'s, make millions.
"""

from amaranth import Cat, Module, Mux, Signal, signed, unsigned
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.debounce import Debounce
from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["KNOBS", "Knob", "KnobPeripheral"]

KNOBS = 3
FILTER_CLOCKS = 64


class Knob(wiring.Component):
    """Count every edge of a hand-wheel.  Domain ``sync``.

    An edge that lasts shows in ``count`` 2 clocks after the strobe that completes it, see
    :class:`rtl.debounce.Debounce`.

    Members
    -------
    a, b : In(1)
        Levels, of this domain, bouncing.  The first levels after reset are 0 0.
    strobe : In(1)
        Time base of the filter.
    periods : In(8)
        Strobes that an edge must last.
    count : Out(signed(16))
        One count per edge, up when ``a`` leads.  Wraps.  0 after reset.
    error : Out(1)
        One-clock strobe: both moved in one clock, which way cannot be known; not counted.
    """

    a: In(1)
    b: In(1)
    strobe: In(1)
    periods: In(8)
    count: Out(signed(16))
    error: Out(1)

    def elaborate(self, platform):
        m = Module()
        m.submodules.a = a = Debounce(width=8)
        m.submodules.b = b = Debounce(width=8)
        for debounce, pin in (a, self.a), (b, self.b):
            m.d.comb += [debounce.i.eq(pin), debounce.strobe.eq(self.strobe), debounce.periods.eq(self.periods)]
        now, last = Signal(2), Signal(2)
        moved = now ^ last
        m.d.comb += [now.eq(Cat(a.o, b.o)), self.error.eq(moved.all())]
        m.d.sync += last.eq(now)
        # Up exactly when the new level of A differs from the old level of B.
        with m.If(moved.xor()):
            m.d.sync += self.count.eq(self.count + Mux(now[0] ^ last[1], 1, -1))
        return m


class KnobPeripheral(wiring.Component):
    """Three hand-wheels on the CSR bus.  Domain ``sync``.

    Knob 0 is the control knob (focus), 1 the X wheel, 2 the Y wheel.

    Members
    -------
    a, b : In(3)
        Channels, asynchronous; a bit for each knob.
    """

    class Filter(Register, access="rw"):
        """What is a bounce."""
        value: Field(action.RW, unsigned(8), init=40, unit="64 clocks",
                     doc="Time that an edge must last to count. Edges of one knob may not come closer than this. "
                         "0 is 1.")

    class Position(Register, access="r"):
        """Place of a knob."""
        value: Field(action.R, signed(16), unit="edges", doc="Four to a line of the encoder, up when A leads. Wraps.")

    class Errors(Register, access="rw"):
        """Signal quality."""
        skipped: Field(action.RW1C, KNOBS, doc="Bit n: both channels of knob n changed at once, and the step was not "
                                               "counted. Write 1 to clear.")

    def __init__(self):
        self._registers = registers = RegisterBank(addr_width=3)
        self._position = [registers.add(self.Position, offset=4 * n, name=f"position{n}") for n in range(KNOBS)]
        self._filter = registers.add(self.Filter, offset=0x10)
        self._errors = registers.add(self.Errors, offset=0x14)
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "a": In(KNOBS), "b": In(KNOBS)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        a, b, since = Signal(KNOBS), Signal(KNOBS), Signal(range(FILTER_CLOCKS))
        m.submodules.a_sync = FFSynchronizer(self.a, a)
        m.submodules.b_sync = FFSynchronizer(self.b, b)
        m.d.sync += since.eq(since + 1)
        for n in range(KNOBS):
            m.submodules[f"knob{n}"] = knob = Knob()
            m.d.comb += [
                knob.a.eq(a[n]), knob.b.eq(b[n]), knob.strobe.eq(since == FILTER_CLOCKS - 1),
                knob.periods.eq(self._filter.f.value.data),
                self._position[n].f.value.r_data.eq(knob.count),
                self._errors.f.skipped.set[n].eq(knob.error),
            ]
        return m
