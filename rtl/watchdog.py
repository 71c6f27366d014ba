# SPDX-License-Identifier: BSD-2-Clause
"""Watchdog: resets a processor that no longer says that it is well, and remembers why for the next one."""

from amaranth import Module, Signal, unsigned
from amaranth.lib import enum, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["Cause", "DRIVES_OFF_CLOCKS", "KICK_WORD", "RESET_CLOCKS", "RESET_WORD", "TIMEOUT_CLOCKS", "Watchdog",
           "WatchdogPeripheral"]

TIMEOUT_CLOCKS = 5_000_000
"""``Timeout`` at reset: 100 ms."""

DRIVES_OFF_CLOCKS = 8
"""From ``expired`` to the processor's reset: the drives are off by then."""

RESET_CLOCKS = 16
"""Length of the reset: what the processor had under way on its buses has ended by then."""

KICK_WORD, RESET_WORD = 0x6b69636b, 0x72657374
"""What is to be written: ``kick`` and ``rest`` in ASCII, most significant byte first."""


class Cause(enum.Enum, shape=2):
    """Why the processor was last reset."""
    POWER_UP = 0
    WATCHDOG = 1
    COMMAND = 2


class Watchdog(wiring.Component):
    """Counts the clocks since the last ``kick`` and resets the processor.  Domain ``sync``.

    Stopped at reset.  From ``enable`` on, a kick is due within ``timeout`` clocks after the last one; one that comes
    later, or in the very clock in which it is missed, changes nothing any more: ``expired`` is high ``timeout`` + 2
    clocks after the clock of the last kick, or of ``enable``, and 1 clock after that of ``reset``.  ``cpu_reset``
    follows :data:`DRIVES_OFF_CLOCKS` later for :data:`RESET_CLOCKS`, and stops the watchdog; kicks, ``enable`` and
    ``reset`` mean nothing from ``expired`` until it ends.

    Members
    -------
    timeout : In(32)
        Clocks; taken with ``enable`` and with each kick.
    enable, kick, reset : In(1)
        Strobes: start watching, which nothing ends but the processor's reset; the processor is well; reset it.
    running : Out(1)
        Watching.
    expired : Out(1)
        One-clock strobe from a flip-flop: the processor is about to be reset; drive nothing that it has asked for.
    cpu_reset : Out(1)
        For the processor and all that may wait for it; from a flip-flop.
    cause : Out(Cause)
        Of the last reset; new with ``expired``.
    """

    def __init__(self):
        self._left = Signal(32)
        self._step = Signal(range(DRIVES_OFF_CLOCKS + RESET_CLOCKS))
        self._resetting = Signal()
        super().__init__({
            "timeout": In(32), "enable": In(1), "kick": In(1), "reset": In(1), "running": Out(1), "expired": Out(1),
            "cpu_reset": Out(1), "cause": Out(Cause),
        })

    def elaborate(self, platform):
        m = Module()
        left, step, resetting = self._left, self._step, self._resetting
        late = Signal()
        m.d.comb += late.eq(self.running & (left == 0))
        m.d.sync += self.expired.eq(0)
        with m.If(resetting):
            m.d.sync += step.eq(step + 1)
            with m.If(step == DRIVES_OFF_CLOCKS - 1):
                m.d.sync += [self.cpu_reset.eq(1), self.running.eq(0)]
            with m.If(step == DRIVES_OFF_CLOCKS + RESET_CLOCKS - 1):
                m.d.sync += [self.cpu_reset.eq(0), resetting.eq(0), step.eq(0)]
        with m.Elif(late | self.reset):
            m.d.sync += [
                self.expired.eq(1), resetting.eq(1), self.cause.eq(Cause.COMMAND),
            ]
            with m.If(late):
                m.d.sync += self.cause.eq(Cause.WATCHDOG)
        with m.Elif(self.kick | (self.enable & ~self.running)):
            m.d.sync += left.eq(self.timeout)
        with m.Else():
            m.d.sync += left.eq(left - 1)
        with m.If(self.enable & ~resetting):
            m.d.sync += self.running.eq(1)
        return m


class WatchdogPeripheral(wiring.Component):
    """Watchdog and reset of the processor on the register bus.  Domain ``sync``.

    The processor's reset reaches no register, here or elsewhere: they keep what they hold.

    Members
    -------
    expired, cpu_reset : Out(1)
        As of the :class:`Watchdog`.
    """

    class Control(Register, access="w"):
        """Start."""
        enable: Field(action.W, 1, doc="1: start watching. Nothing ends it but a reset of the processor.")

    class Timeout(Register, access="rw"):
        """Patience."""
        value: Field(action.RW, unsigned(32), init=TIMEOUT_CLOCKS, unit="clocks",
                     doc="Most clocks from one kick to the next. Taken with enable and with each kick.")

    class Kick(Register, access="w"):
        """The processor is well."""
        word: Field(action.W, 32, doc="Write 0x6b69636b; any other word is none.")

    class Status(Register, access="rw"):
        """Past and present."""
        cause: Field(action.R, 2, doc="Of the processor's last reset. 0: power-up. 1: the watchdog. 2: Reset was written.")
        running: Field(action.R, 1, doc="Watching.")
        cold: Field(action.RW1C, 1, init=1, doc="Since the gateware was loaded or reset as a whole, what RAM holds is what "
                                                "came with it. Write 1 to clear.")

    class Reset(Register, access="w"):
        """Reset of the processor."""
        word: Field(action.W, 32, doc="Write 0x72657374: the drives go off and the processor is reset.")

    class Scratch(Register, access="rw"):
        """A word for the program that runs next."""
        value: Field(action.RW, unsigned(32), doc="Survives a reset of the processor. 0 at power-up.")

    def __init__(self):
        self._watchdog = Watchdog()
        self._registers = registers = RegisterBank(addr_width=4)
        self._control = registers.add(self.Control, offset=0x00)
        self._timeout = registers.add(self.Timeout, offset=0x04)
        self._kick = registers.add(self.Kick, offset=0x08)
        self._status = registers.add(self.Status, offset=0x0c)
        self._reset = registers.add(self.Reset, offset=0x10)
        registers.add(self.Scratch, offset=0x14)
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "expired": Out(1), "cpu_reset": Out(1)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.watchdog = watchdog = self._watchdog
        connect(m, flipped(self.bus), self._registers.bus)
        enable, kick, reset = self._control.f.enable, self._kick.f.word, self._reset.f.word
        m.d.comb += [
            watchdog.timeout.eq(self._timeout.f.value.data),
            watchdog.enable.eq(enable.w_stb & enable.w_data),
            watchdog.kick.eq(kick.w_stb & (kick.w_data == KICK_WORD)),
            watchdog.reset.eq(reset.w_stb & (reset.w_data == RESET_WORD)),
            self._status.f.cause.r_data.eq(watchdog.cause), self._status.f.running.r_data.eq(watchdog.running),
            self.expired.eq(watchdog.expired), self.cpu_reset.eq(watchdog.cpu_reset),
        ]
        return m
