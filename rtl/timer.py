# SPDX-License-Identifier: BSD-2-Clause
"""System timer: one counter that never stops, and one alarm.

luna-soc's timer counts down 32 bits behind an 8-bit bus and restarts when it is set; firmware here wants one
time base that all parts share, so this is a counter with a compare instead.
"""

from amaranth import Module, Signal, signed, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["Timer", "TimerPeripheral"]


class Timer(wiring.Component):
    """A 64-bit counter with a one-shot alarm.  Domain ``sync``.

    Parameters
    ----------
    init : int
        ``count`` at reset.

    Members
    -------
    count : Out(64)
        Clocks since reset.  Wraps after 11,700 years at 50 MHz.
    alarm : In(32)
        Low half of the count to wait for.  Hold still while ``armed``.
    arm, cancel : In(1)
        Strobes; ``cancel`` wins.
    armed : Out(1)
        Waiting.
    expired : Out(1)
        One-clock strobe: ``count`` has reached ``alarm``.  High 1 clock after the clock on which the low half of
        ``count`` equals ``alarm``; an alarm at most 2^31 clocks in the past expires 2 clocks after ``arm``.
    """

    def __init__(self, *, init=0):
        super().__init__({"count": Out(64, init=init), "alarm": In(32), "arm": In(1), "cancel": In(1),
                          "armed": Out(1), "expired": Out(1)})

    def elaborate(self, platform):
        m = Module()
        m.d.sync += self.count.eq(self.count + 1)

        # Negative while the alarm lies ahead, in the arithmetic of a counter that wraps.
        since_alarm = Signal(signed(32))
        m.d.comb += since_alarm.eq(self.count[:32] - self.alarm)
        reached = self.armed & (since_alarm >= 0)
        m.d.sync += self.expired.eq(reached & ~self.cancel)
        with m.If(self.arm):
            m.d.sync += self.armed.eq(1)
        with m.If(self.cancel | (reached & ~self.arm)):
            m.d.sync += self.armed.eq(0)
        return m


class TimerPeripheral(wiring.Component):
    """The timer on the CSR bus.  Domain ``sync``.

    Parameters
    ----------
    init : int
        The count at reset.

    Members
    -------
    interrupt : Out(1)
        High while ``Interrupt.alarm`` is set.
    count : Out(32)
        What ``Count`` reads as, for stamps of other blocks.
    """

    class Count(Register, access="r"):
        """Live count, for intervals up to 85 s."""
        value: Field(action.R, unsigned(32), unit="clocks", doc="Low half. Wraps.")

    class Control(Register, access="w"):
        """Commands."""
        latch: Field(action.W, 1, doc="1: copy the whole count to LatchedLow and LatchedHigh.")
        arm: Field(action.W, 1, doc="1: wait for Alarm.")
        cancel: Field(action.W, 1, doc="1: stop waiting; wins over arm.")

    class LatchedLow(Register, access="r"):
        """Count at the last latch, low half."""
        value: Field(action.R, unsigned(32), unit="clocks", doc="Bits 31 to 0.")

    class LatchedHigh(Register, access="r"):
        """Count at the last latch, high half."""
        value: Field(action.R, unsigned(32), unit="clocks", doc="Bits 63 to 32.")

    class Alarm(Register, access="rw"):
        """When to interrupt. Set, then arm."""
        value: Field(action.RW, unsigned(32), unit="clocks",
                     doc="Value of Count. Up to 2^31 ahead; one that has passed expires at once.")

    class Status(Register, access="r"):
        """State of the alarm."""
        armed: Field(action.R, 1, doc="Waiting for Alarm.")

    class Interrupt(Register, access="rw"):
        """Interrupt requests; a set bit holds the interrupt line."""
        alarm: Field(action.RW1C, 1, doc="The alarm expired. Write 1 to clear.")

    def __init__(self, *, init=0):
        self._timer = Timer(init=init)
        self._registers = registers = RegisterBank(addr_width=3)
        self._count = registers.add(self.Count, offset=0x00)
        self._control = registers.add(self.Control, offset=0x04)
        self._latched_low = registers.add(self.LatchedLow, offset=0x08)
        self._latched_high = registers.add(self.LatchedHigh, offset=0x0c)
        self._alarm = registers.add(self.Alarm, offset=0x10)
        self._status = registers.add(self.Status, offset=0x14)
        self._interrupt = registers.add(self.Interrupt, offset=0x18)
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "interrupt": Out(1),
                          "count": Out(32)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.timer = timer = self._timer
        connect(m, flipped(self.bus), self._registers.bus)

        control = self._control.f
        latched = Signal(64)
        with m.If(control.latch.w_stb & control.latch.w_data):
            m.d.sync += latched.eq(timer.count)
        m.d.comb += [
            timer.alarm.eq(self._alarm.f.value.data),
            timer.arm.eq(control.arm.w_stb & control.arm.w_data),
            timer.cancel.eq(control.cancel.w_stb & control.cancel.w_data),
            self._count.f.value.r_data.eq(timer.count[:32]),
            self._latched_low.f.value.r_data.eq(latched[:32]),
            self._latched_high.f.value.r_data.eq(latched[32:]),
            self._status.f.armed.r_data.eq(timer.armed),
            self._interrupt.f.alarm.set.eq(timer.expired),
            self.interrupt.eq(self._interrupt.f.alarm.data), self.count.eq(timer.count),
        ]
        return m
