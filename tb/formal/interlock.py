# SPDX-License-Identifier: BSD-2-Clause
"""The way from a fault to the pins: whatever the bus does, or if it does nothing for ever."""

from amaranth import Cat, Const, Mux, Signal
from amaranth.lib.wiring import connect

from rtl.pwm import PwmPeripheral
from tb.formal.divider import register
from tb.formal.proof import AnySeq, Assert, Cover, Proof, two_clocks

PERIOD = 4
CLEAR = 2                   # word of the register


class AFaultIsOffUntilItIsCleared(Proof):
    """Anything on both buses, anything from encoders, watchdog and stop, with every interleaving of ``fast``: 2 ``sync``
    clocks, 8 of ``fast``, after a detector says fault the axis' drive is off, as all are after the watchdog's; and it
    stays so until it is cleared in a clock without the cause.  The stop holds all off within a clock of its
    synchroniser.  Nothing else does."""

    block = "rtl.interlock"
    depth = 6
    cover_depth, bug_depth = 24, 12
    widths = "4 axes, 18 faults, two buses, two clocks"
    bugs = {
        "a clear wins over its cause": ("(self.faults & ~self.clear) | self.cause",
                                        "(self.faults | self.cause) & ~self.clear"),
        "a fault is not kept": ("(self.faults & ~self.clear) | self.cause", "self.cause"),
        "any clear clears all": ("(self.faults & ~self.clear)", "(self.faults & ~self.clear.any().replicate(FAULTS))"),
        "the watchdog holds nothing off": ("self.faults[WATCHDOG] | self.cause[ESTOP]", "self.cause[ESTOP]"),
        "the stop is kept instead": ("self.faults[WATCHDOG] | self.cause[ESTOP]",
                                     "self.faults[WATCHDOG] | self.faults[ESTOP]"),
        "an axis is forgotten": ("for axis in range(AXES):\n            m.d.comb += self.inhibit",
                                 "for axis in range(AXES - 1):\n            m.d.comb += self.inhibit"),
        "one fault is for another axis": ("self.faults[axis:WATCHDOG:AXES]", "self.faults[axis ^ 1:WATCHDOG:AXES]"),
        "a read clears": ("Mux(field.w_stb, field.w_data, 0)", "field.w_data"),
    }

    def harness(self, m, block):
        tick = Signal()
        always = Const(1)
        dut, pwm = block.InterlockPeripheral(), PwmPeripheral(period_clocks=PERIOD)
        m.submodules.dut, _ = two_clocks(dut, fast=tick, sync=always)
        m.submodules.pwm, _ = two_clocks(pwm, sync=always)
        m.d.comb += tick.eq(AnySeq(1))
        buses = [getattr(part.bus, name) for part in (dut, pwm) for name in ("addr", "r_stb", "w_stb", "w_data")]
        for pin in dut.estop, dut.expired, dut.illegal, *dut.low, pwm.latched_stb, *buses:
            m.d.comb += pin.eq(AnySeq(len(pin)))
        m.d.comb += [pwm.inhibit.eq(dut.inhibit), *(dut.drive[n].eq(pwm.drive[n]) for n in range(block.AXES))]

        cause, axes = Signal(block.FAULTS), block.AXES
        m.d.comb += cause.eq(dut._latch.cause)
        # What a write to Clear says takes effect a clock after its strobe.
        clear = register(m, block.FAULTS, Mux(dut.bus.w_stb & (dut.bus.addr == CLEAR), dut.bus.w_data, 0))
        kept = Signal(block.FAULTS)
        m.d.formal += kept.eq(Mux(clear, kept & ~clear, kept) | cause)
        stop = register(m, 1, dut.estop)
        before = register(m, 1, stop)
        off = Signal(axes)
        for n in range(axes):
            m.d.comb += off[n].eq(Cat(*(kept[n + axes * fault] for fault in range(4)), kept[16], cause[17]).any())
        was_off = register(m, axes, off)
        m.d.comb += [
            Assert(dut.inhibit == off), Assert((pwm.pwm & was_off) == 0), Assert(~was_off.all() | ~pwm.motor_enable),
            # Two clocks of it are enough for a synchroniser that resolves late.
            Assert(~(stop & before & register(m, 1, before)) | cause[17]),
            *self.lemmas(dut._latch.faults == kept),
            Cover(pwm.pwm.all() & (kept[:16] == 0)), Cover((pwm.pwm == 0b0111) & was_off[3] & ~was_off[0]),
            Cover(register(m, 1, kept[16]) & ~kept[16] & (off == 0)),
        ]
