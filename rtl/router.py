# SPDX-License-Identifier: BSD-2-Clause
"""Pin router: which signal each output pin shows, and with which polarity."""

from amaranth import Module, Signal
from amaranth.lib import data, enum, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["PINS", "ROUTER_LATENCY", "PinRouter", "Route", "RouterPeripheral", "Routes", "Source"]


class Source(enum.Enum, shape=4):
    """What a pin shows.  Codes not named here show low."""
    LOW = 0
    HIGH = 1
    SYNC = 2
    PIXEL = 3
    DIRECT = 4
    LED = 5


Route = data.StructLayout({"source": 4, "invert": 1})
"""``source``: a code of :class:`Source`.  ``invert``: 1 inverts it, whatever it is."""

PINS = {"out0": Source.LOW, "sync_out": Source.SYNC, "encoder_out": Source.PIXEL}
"""The pins, and what each shows at reset."""

ROUTER_LATENCY = 2
"""``fast`` clocks from a source to the pin: 1 route, 1 pin, whose flip-flop may sit in the pin's cell."""

Routes = data.StructLayout({pin: Route for pin in PINS})


class PinRouter(wiring.Component):
    """Select a source for each pin; every pin is a flip-flop.

    Domain ``fast``.  Latency 2 clocks (:data:`ROUTER_LATENCY`), for all sources and pins alike.  A pin changes only in the clock in which
    its source or its route does.

    Members
    -------
    routes : In(Routes)
    sync, pixel, direct, light : In(1)
        Sources.
    out0, sync_out, encoder_out : Out(1)
        Pins.  0 at reset.
    """

    def __init__(self):
        super().__init__({"routes": In(Routes), "sync": In(1), "pixel": In(1), "direct": In(1), "light": In(1),
                          **{pin: Out(1) for pin in PINS}})

    def elaborate(self, platform):
        m = Module()
        for pin in PINS:
            route = getattr(self.routes, pin)
            level = Signal(name=f"{pin}_level")
            with m.Switch(route.source):
                for source, value in ((Source.HIGH, 1), (Source.SYNC, self.sync), (Source.PIXEL, self.pixel),
                                      (Source.DIRECT, self.direct), (Source.LED, self.light)):
                    with m.Case(source.value):
                        m.d.comb += level.eq(value)
            routed = Signal(name=f"{pin}_routed")
            m.d.fast += [routed.eq(level ^ route.invert), getattr(self, pin).eq(routed)]
        return m


class RouterPeripheral(wiring.Component):
    """Registers of the pin router.  Domain ``sync``.

    Members
    -------
    bus : In(csr)
    routes : Out(Routes)
    """

    class Out0(Register, access="rw"):
        """Pin OUT0.  Takes effect within 240 ns, source and polarity in the same clock."""
        source: Field(action.RW, 4, init=PINS["out0"].value,
                      doc="0 low, 1 high, 2 SYNC (the active line), 3 pixel clock, 4 direct (channel A of the "
                          "divider's axis), 5 modulation of a lamp (LED); others low.")
        invert: Field(action.RW, 1, doc="Inverts the pin, after selection.")

    class Sync(Register, access="rw"):
        """Pin SYNC, as Out0."""
        source: Field(action.RW, 4, init=PINS["sync_out"].value, doc="As for Out0.")
        invert: Field(action.RW, 1, doc="Inverts the pin, after selection.")

    class Encoder(Register, access="rw"):
        """Pin ENCODER, as Out0."""
        source: Field(action.RW, 4, init=PINS["encoder_out"].value, doc="As for Out0.")
        invert: Field(action.RW, 1, doc="Inverts the pin, after selection.")

    def __init__(self):
        self._registers = RegisterBank(addr_width=2)
        self._pins = {
            "out0": self._registers.add(self.Out0, offset=0x0),
            "sync_out": self._registers.add(self.Sync, offset=0x4),
            "encoder_out": self._registers.add(self.Encoder, offset=0x8),
        }
        memory_map = self._registers.finish()
        super().__init__({"bus": In(self._registers.bus_signature), "routes": Out(Routes)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        for pin, register in self._pins.items():
            m.d.comb += [
                getattr(self.routes, pin).source.eq(register.f.source.data),
                getattr(self.routes, pin).invert.eq(register.f.invert.data),
            ]
        return m
