# SPDX-License-Identifier: BSD-2-Clause
"""Motor PWM, and the servo tick that is an integer division of its period."""

from amaranth import Module, Mux, Signal, signed, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["AXES", "DUTY_PERIODS", "PERIOD_CLOCKS", "Pwm", "PwmPeripheral", "ServoTick"]

AXES = 4
PERIOD_CLOCKS = 2500
DUTY_PERIODS = 2
"""PWM periods from a servo tick to the duties it causes, unless set otherwise: 100 us for the firmware."""


class Pwm(wiring.Component):
    """One sign-magnitude PWM channel.  Domain ``sync``.

    ``duty`` is taken on the clock of ``start``; the pins follow 2 clocks later: ``pwm`` is high for the first
    ``abs(duty)`` clocks of the period and low for the rest, and ``dir`` changes nowhere else.

    ``off`` forces ``pwm`` low 1 clock later, whatever the period is doing.  It stays low for the rest of that
    period and starts again with the first ``start`` at which ``off`` is low.  ``dir`` keeps its level.

    Parameters
    ----------
    period_clocks : int
        Length of a period, 2 to 4095.

    Members
    -------
    duty : In(signed(13))
        Clocks of drive in a period; the sign is the direction.  Clamped to +- ``period_clocks``.
    off : In(1)
        Hold the drive off.
    start : In(1)
        One-clock strobe at the start of a period.
    phase : In(12)
        Clocks since the period started: 0 on the clock after ``start``.
    pwm, dir : Out(1)
        Pins, from flip-flops, low after reset.  ``dir`` = 1 drives toward +; 0 for a duty of 0.
    drive : Out(signed(13))
        The present drive: the duty of this period, as it was clamped; 0 from the clock after ``off`` on.
    """

    def __init__(self, *, period_clocks=PERIOD_CLOCKS):
        if not 2 <= period_clocks < 1 << 12:
            raise ValueError(f"period_clocks must be 2 to 4095, not {period_clocks!r}")
        self._period_clocks = period_clocks
        # Of this period; for proofs.
        self._on_clocks, self._direction = Signal(12, name="on_clocks"), Signal(name="direction")
        super().__init__({"duty": In(signed(13)), "off": In(1), "start": In(1), "phase": In(unsigned(12)),
                          "pwm": Out(1), "dir": Out(1), "drive": Out(signed(13))})

    def elaborate(self, platform):
        m = Module()
        magnitude = Signal(13)
        on_clocks, direction = self._on_clocks, self._direction
        m.d.comb += magnitude.eq(Mux(self.duty < 0, -self.duty, self.duty))
        with m.If(self.off):
            m.d.sync += on_clocks.eq(0)
        with m.Elif(self.start):
            m.d.sync += [
                on_clocks.eq(Mux(magnitude > self._period_clocks, self._period_clocks, magnitude)),
                direction.eq(self.duty > 0),
            ]
        m.d.sync += [
            self.pwm.eq((self.phase < on_clocks) & ~self.off),
            self.dir.eq(direction),
        ]
        m.d.comb += self.drive.eq(Mux(direction, on_clocks, -on_clocks))
        return m


class ServoTick(wiring.Component):
    """Every ``divider``-th start of a PWM period, and the one between two of them at which duties are taken.

    Domain ``sync``.

    Members
    -------
    start : In(1)
        One-clock strobe at the start of a PWM period.
    divider : In(8)
        Periods per tick; 0 = no ticks.  Taken at a tick, or at once when it was 0.
    delay : In(8)
        Periods from a tick to ``take``; 0, or more than there are: at the next tick.
    tick : Out(1)
        One-clock strobe, 1 clock after the ``start`` it belongs to.
    take : Out(1)
        On the clock of one ``start`` in each servo period; of every ``start`` while there are no ticks.
    """

    start: In(1)
    divider: In(8)
    delay: In(8)
    tick: Out(1)
    take: Out(1)

    def __init__(self):
        super().__init__()
        # State, for proofs: starts before the next tick; starts before the duties are taken, if they are to be.
        self._left, self._wait, self._waiting = Signal(8, name="left"), Signal(8, name="wait"), Signal(name="waiting")

    def elaborate(self, platform):
        m = Module()
        left, wait, waiting = self._left, self._wait, self._waiting
        due = self.start & (left == 0) & (self.divider != 0)
        stopped = (left == 0) & (self.divider == 0)
        m.d.comb += self.take.eq(self.start & (stopped | (waiting & ((wait == 0) | due))))
        m.d.sync += self.tick.eq(due)
        with m.If(due):
            m.d.sync += [left.eq(self.divider - 1), wait.eq(self.delay - 1), waiting.eq(1)]
        with m.Elif(self.start):
            m.d.sync += wait.eq(wait - 1)
            with m.If(left != 0):
                m.d.sync += left.eq(left - 1)
            with m.If(self.take):
                m.d.sync += waiting.eq(0)
        return m


class PwmPeripheral(wiring.Component):
    """Four PWM channels and the servo tick on the CSR bus.  Domain ``sync``.

    The order of things in a servo period: a PWM period starts, ``tick_stb`` asks for the snapshot 1 clock
    later, ``latched_stb`` answers, and ``interrupt`` rises 1 clock after that.  The duties of all axes are taken
    together at the start of the PWM period ``DutyDelay`` periods after the tick, whenever before it they were
    written: so the time from a snapshot to the drive it causes is constant, whatever the processor does.

    An axis that was off, by ``inhibit`` or by its ``enable``, is driven again by duties taken after its release.

    Parameters
    ----------
    period_clocks : int
        Length of a PWM period; 2500 clocks of 20 ns are 50 us, 20 kHz.

    Members
    -------
    inhibit : In(4)
        Interlock: these drives off 1 clock later, see :class:`Pwm`.
    tick_stb : Out(1)
        Servo tick: take a snapshot now.
    latched_stb : In(1)
        The snapshot asked for is readable.
    interrupt : Out(1)
        High while ``Interrupt.tick`` is set.
    pwm, dir : Out(4)
        Motor pins, one bit per axis, from flip-flops, low after reset.
    motor_enable : Out(1)
        Power stages on: some axis is enabled that the interlock does not hold off.  From a flip-flop, low after
        reset, 1 clock after its causes.
    drive : Out(signed(13)).array(4)
        Present drives, see :class:`Pwm`.
    """

    class Duty(Register, access="rw"):
        """Drive of one axis."""
        value: Field(action.RW, signed(13), unit="clocks of 2500",
                     doc="-2500 to 2500, clamped; positive drives toward +. Taken with those of the other "
                         "axes, DutyDelay after a servo tick.")

    class Control(Register, access="rw"):
        """Which axes may be driven."""
        enable: Field(action.RW, 4, doc="Bit n: axis n is driven, from the next time that duties are "
                                        "taken. Cleared: its pin goes low at once.")

    class TickDivider(Register, access="rw"):
        """Rate of the servo tick."""
        value: Field(action.RW, unsigned(8), init=4, unit="PWM periods",
                     doc="Periods per servo tick; 0 stops it. Taken at a tick.")

    class DutyDelay(Register, access="rw"):
        """Time from a servo tick to the duties it causes."""
        value: Field(action.RW, unsigned(8), init=DUTY_PERIODS, unit="PWM periods",
                     doc="Duties are taken at the start of the PWM period so many after the servo tick; 0, or more "
                         "than TickDivider: at the next tick. Without ticks, at every period. Taken at a tick.")

    class Status(Register, access="r"):
        """State of the drives."""
        inhibited: Field(action.R, AXES, doc="Bit n: the interlock holds axis n off now.")
        driven: Field(action.R, 4, doc="Bit n: the pin of axis n is high now.")

    class Interrupt(Register, access="rw"):
        """Servo tick; a set tick holds the interrupt line."""
        tick: Field(action.RW1C, 1, doc="The snapshot of a servo tick is ready. Write 1 to clear.")
        overrun: Field(action.RW1C, 1, doc="A tick came while tick was still set: the servo loop is late. "
                                           "Write 1 to clear.")

    def __init__(self, *, period_clocks=PERIOD_CLOCKS):
        self._period_clocks = period_clocks
        self._registers = registers = RegisterBank(addr_width=4)
        self._duty = [registers.add(self.Duty, offset=4 * n, name=f"duty{n}") for n in range(AXES)]
        self._control = registers.add(self.Control, offset=0x10)
        self._tick_divider = registers.add(self.TickDivider, offset=0x14)
        self._status = registers.add(self.Status, offset=0x18)
        self._interrupt = registers.add(self.Interrupt, offset=0x1c)
        self._duty_delay = registers.add(self.DutyDelay, offset=0x20)
        memory_map = registers.finish()
        super().__init__({
            "bus": In(registers.bus_signature), "inhibit": In(AXES), "tick_stb": Out(1), "latched_stb": In(1),
            "interrupt": Out(1), "pwm": Out(AXES), "dir": Out(AXES), "motor_enable": Out(1),
            "drive": Out(signed(13)).array(AXES),
        })
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)

        phase = Signal(12)
        start = Signal()
        m.d.comb += start.eq(phase == self._period_clocks - 1)
        m.d.sync += phase.eq(Mux(start, 0, phase + 1))

        m.submodules.tick = tick = ServoTick()
        enable = self._control.f.enable.data
        for n, duty in enumerate(self._duty):
            m.submodules[f"axis{n}"] = axis = Pwm(period_clocks=self._period_clocks)
            taken = Signal(signed(13), name=f"taken{n}")
            # What was taken before an axis went off must not drive it when it is released.
            with m.If(axis.off):
                m.d.sync += taken.eq(0)
            with m.Elif(tick.take):
                m.d.sync += taken.eq(duty.f.value.data)
            m.d.comb += [
                axis.duty.eq(Mux(tick.take, duty.f.value.data, taken)), axis.off.eq(self.inhibit[n] | ~enable[n]),
                axis.start.eq(start), axis.phase.eq(phase),
                self.pwm[n].eq(axis.pwm), self.dir[n].eq(axis.dir), self.drive[n].eq(axis.drive),
            ]
        m.d.sync += self.motor_enable.eq((enable & ~self.inhibit).any())

        interrupt = self._interrupt.f
        m.d.comb += [
            tick.start.eq(start), tick.divider.eq(self._tick_divider.f.value.data),
            tick.delay.eq(self._duty_delay.f.value.data),
            self.tick_stb.eq(tick.tick),
            interrupt.tick.set.eq(self.latched_stb),
            interrupt.overrun.set.eq(tick.tick & interrupt.tick.data),
            self.interrupt.eq(interrupt.tick.data),
            self._status.f.inhibited.r_data.eq(self.inhibit),
            self._status.f.driven.r_data.eq(self.pwm),
        ]
        return m
