# SPDX-License-Identifier: BSD-2-Clause
"""Pulse-width modulation for a lamp: every period whole, whatever is set and whenever."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.countdown import Countdown
from rtl.crossing import Handover
from rtl.pulse import Pulse
from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["LEAD_CLOCKS", "LENGTH_BITS", "PERIOD_MIN", "PERIOD_RESET", "LedPeripheral", "LedPwm", "LedSettings"]

LENGTH_BITS = 21
"""Of a period in ``fast`` clocks: 100 Hz are 2,000,000."""

LEAD_CLOCKS = 3
"""From the clock that takes the settings of a period to its first clock."""

PERIOD_MIN = LEAD_CLOCKS + 1
PERIOD_RESET = 153_846
"""1.3 kHz of 200 MHz."""

LedSettings = data.StructLayout({"rest": LENGTH_BITS, "on": LENGTH_BITS, "lit": 1})
"""``rest``: clocks of a period less :data:`LEAD_CLOCKS`, at least 1.  ``on``: of them high, at most the period.
``lit``: ``on`` is not 0."""


class LedPwm(wiring.Component):
    """One period after the other: high for its first ``on`` clocks, low for the rest.

    Domain ``fast``.  The settings of a period, its length among them, are those of the clock
    :data:`LEAD_CLOCKS` before its first one; what is set later waits for the next period, which begins at once if
    the present one is dark.  A period with 0 is never high, one with its whole length never low, also at its borders.

    Members
    -------
    settings : In(LedSettings)
    level : Out(1)
        From a flip-flop; 0 at reset.  The first period begins 3 clocks after it.
    """

    def __init__(self):
        # State, for proofs.  ``present``: settings of the period that begins next, or has begun.
        self._period, self._pulse = Countdown(width=LENGTH_BITS), Pulse(width=LENGTH_BITS)
        self._present, self._lead = Signal(LedSettings), Signal(LEAD_CLOCKS, init=1)
        super().__init__({"settings": In(LedSettings), "level": Out(1)})

    def elaborate(self, platform):
        m = Module()
        m.submodules.period = period = self._period
        m.submodules.pulse = pulse = self._pulse
        present, lead = self._present, self._lead

        # The last clocks of a period: its count is over, the next one's settings are taken, settled and loaded.
        end = (period.last | (~present.lit & self.settings.lit)) & (lead == 0)
        m.d.fast += lead.eq((lead << 1) | end)
        with m.If(lead[0]):
            m.d.fast += present.eq(self.settings)
        m.d.comb += [
            period.value.eq(present.rest), period.load.eq(lead[-1]), period.step.eq(1),
            pulse.width.eq(present.on), pulse.trigger.eq(lead[-1] & present.lit),
            self.level.eq(pulse.pulse),
        ]
        return m


class LedPeripheral(wiring.Component):
    """The lamp's modulation with its registers.

    Registers in ``sync``, the modulation in ``fast``.  ``Period`` and ``On`` go over together with ``Control.load``,
    and hold from the next period on that begins 110 ns after the write or later, if ``Status.busy`` was 0; a dark period
    ends for them at once.  Of loads that come closer than they go over the last counts.

    Members
    -------
    bus : In(csr)
    light : Out(1), fast
        The modulation, for the pin router.
    """

    class Period(Register, access="rw"):
        """Length of a period.  Taken with ``Control.load``."""
        value: Field(action.RW, LENGTH_BITS, init=PERIOD_RESET, unit="fast clocks",
                     doc="200,000,000 by the frequency. Less than 4 is 4.")

    class On(Register, access="rw"):
        """High part of a period.  Taken with ``Control.load``."""
        value: Field(action.RW, LENGTH_BITS, unit="fast clocks",
                     doc="0: never high. The period or more: never low.")

    class Control(Register, access="w"):
        """Commands."""
        load: Field(action.W, 1, doc="1: Period and On, as they are now, hold together from the next period on, for which a dark one "
                                     "ends at once.")

    class Status(Register, access="r"):
        """State."""
        busy: Field(action.R, 1, doc="What was loaded last is on its way; else it waits for the next period, or holds.")

    def __init__(self):
        self._registers = registers = RegisterBank(addr_width=2)
        self._period = registers.add(self.Period, offset=0x0)
        self._on = registers.add(self.On, offset=0x4)
        self._control = registers.add(self.Control, offset=0x8)
        self._status = registers.add(self.Status, offset=0xc)
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "light": Out(1)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.pwm = pwm = LedPwm()
        dark = {"rest": PERIOD_RESET - LEAD_CLOCKS}
        m.submodules.handover = handover = Handover(LedSettings, source="sync", destination="fast", init=dark)
        connect(m, flipped(self.bus), self._registers.bus)

        period, on, loaded = Signal(LENGTH_BITS), self._on.f.value.data, Signal()
        load = self._control.f.load.w_stb & self._control.f.load.w_data
        wanted = Signal(LedSettings, init=dark)
        m.d.comb += period.eq(Mux(self._period.f.value.data < PERIOD_MIN, PERIOD_MIN, self._period.f.value.data))
        m.d.sync += loaded.eq(load)
        with m.If(load):
            m.d.sync += [
                wanted.rest.eq(period - LEAD_CLOCKS), wanted.on.eq(Mux(on > period, period, on)), wanted.lit.eq(on != 0),
            ]
        m.d.comb += [
            handover.payload.eq(wanted), handover.request.eq(loaded), pwm.settings.eq(handover.o),
            self._status.f.busy.r_data.eq(load | loaded | ~handover.ready), self.light.eq(pwm.level),
        ]
        return m
