# SPDX-License-Identifier: BSD-2-Clause
"""Position compare: begins the active line when the stage crosses a reference edge."""

from amaranth import Cat, Module, Mux, Signal, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.quadrature import StepStream
from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["CompareSettings", "ComparePeripheral", "PositionCompare"]

WIDTH = 32
SLICE = 8


CompareSettings = data.StructLayout({"axis": 2, "reverse": 1, "reference": signed(WIDTH)})
"""``axis``: whose steps are compared.  ``reverse``: 1 scans toward lower counts.  ``reference``: an edge."""


class PositionCompare(wiring.Component):
    """Become active when armed and the reference edge is crossed in the scan direction.

    Domain ``fast``.  A step on ``step`` in clock 0 is judged in clock 1; ``fired`` and ``active`` show it in
    clock 2, so 2 clocks of latency, at one step per clock.

    The reference is an edge: edge ``e`` is crossed upward by the step that makes count ``e``, downward by the
    one that makes ``e - 1``.

    Arming judges the stage on exactly one sample: the count that ``step`` shows in the clock after ``arm``.
    With the step of that sample crossing the edge, or done with it before, arming is ``late`` and never fires.
    "Before" is a signed difference of 32 bits, so references up to 2**31 - 1 counts ahead are ahead.  From the
    next step on, the first crossing in the scan direction fires: once per arming, however the stage dithers.

    Members
    -------
    step : In(StepStream())
        Steps of the axis that ``settings.axis`` names, one clock after the setting (a registered selector).
    settings : In(CompareSettings)
        Held still from the clock of ``arm`` until the next ``arm`` or ``disarm``.
    arm : In(1)
        Strobe: end what is under way and arm anew.
    disarm : In(1)
        Strobe: end what is under way.  Wins over ``arm``.
    done : In(1)
        Strobe: the active line is complete.
    armed : Out(1)
        Waiting for the edge; from 3 clocks after ``arm``.
    active : Out(1)
        From the crossing until ``done``, ``arm`` or ``disarm``; falls one clock after the strobe.
    fired : Out(1)
        One-clock strobe: the edge was crossed.
    late : Out(1)
        The last arming was at or past its reference; until the next ``arm`` or ``disarm``.
    judged : Out(1)
        One-clock strobe, 3 clocks after ``arm`` or ``disarm``: it has had its effect on ``armed`` and ``late``.
    """

    def __init__(self):
        super().__init__({
            "step": In(StepStream(WIDTH)), "settings": In(CompareSettings), "arm": In(1), "disarm": In(1),
            "done": In(1), "armed": Out(1), "active": Out(1), "fired": Out(1), "late": Out(1), "judged": Out(1),
        })

    def elaborate(self, platform):
        m = Module()
        reverse = self.settings.reverse

        # Clock 0 after ``arm``: the count that the crossing makes.
        ending = Signal()
        target = Signal(signed(WIDTH))
        sampled = Signal()                          # ``step`` is the sample that judges an arming
        m.d.comb += ending.eq(self.arm | self.disarm)
        m.d.fast += [
            target.eq(self.settings.reference - reverse),
            sampled.eq(self.arm & ~self.disarm),
        ]

        # Clock 1: equality by bytes, and the sign of the difference by halves, without and with a borrow.
        half = WIDTH // 2
        count = self.step.count
        upper, target_upper = count[half:], target[half:]
        equal = Signal(WIDTH // SLICE)
        along = Signal()                            # a step in the scan direction
        no_borrow, signs = Signal(), Signal(2)
        judging = Signal()
        m.d.fast += [
            equal.eq(Cat(count[n:n + SLICE] == target[n:n + SLICE] for n in range(0, WIDTH, SLICE))),
            along.eq(self.step.moved & (self.step.up ^ reverse)),
            no_borrow.eq(count[:half] >= target[:half]),
            signs.eq(Cat((upper - target_upper)[half - 1], (upper + ~target_upper)[half - 1])),
            judging.eq(sampled & ~ending),
        ]

        # Clock 2: the verdict.
        at, below, reached, crossed = Signal(), Signal(), Signal(), Signal()
        m.d.comb += [
            at.eq(equal.all()),
            below.eq(Mux(no_borrow, signs[0], signs[1])),
            reached.eq(at | ~(below ^ reverse)), crossed.eq(self.armed & along & at),
        ]
        # Flat, as the crossing comes late in the clock.  ``judging`` finds ``armed`` and ``late`` at 0.
        m.d.fast += [
            self.armed.eq(~ending & ((judging & ~reached) | (self.armed & ~crossed))),
            self.late.eq(~ending & ((judging & reached) | self.late)),
            self.active.eq(~ending & (crossed | (self.active & ~self.done))),
            self.fired.eq(~ending & crossed),
        ]

        answering = Signal(2)
        m.d.fast += [answering.eq(Cat(ending, answering)), self.judged.eq(answering[1])]
        return m


class ComparePeripheral(wiring.Component):
    """Registers of the active line: where it begins, its arming, and its events.  Domain ``sync``.

    To scan a line: clear ``Interrupt``, set ``Config``, ``Reference`` and the divider's registers, write
    ``Control.arm``, wait for ``Status.busy`` = 0, see that ``armed`` is set, then start the stage.

    Members
    -------
    bus : In(csr)
    settings : Out(CompareSettings)
    arm, disarm : Out(1)
        Strobes: written to ``Control``.
    armed, active, late, busy : In(1)
        Levels for ``Status``.
    started, finished, went_late : In(1)
        Strobes that set ``Interrupt``.
    interrupt : Out(1)
        Level: a bit of ``Interrupt`` is set.
    """

    class Config(Register, access="rw"):
        """Axis and direction of the line.  Taken at arming."""
        axis: Field(action.RW, 2, doc="Axis whose position begins the line (SYNC): 0 X, 1 Y, 2 Z, 3 F.")
        reverse: Field(action.RW, 1, doc="The line is scanned toward lower counts.")

    class Reference(Register, access="rw"):
        """Where the line begins.  Taken at arming."""
        value: Field(action.RW, signed(WIDTH), unit="edges",
                     doc="Edge e lies between counts e - 1 and e, so it is the same place in both directions.")

    class Control(Register, access="w"):
        """Begins and ends a line.  Leave all settings alone until busy is 0: they are taken meanwhile."""
        arm: Field(action.W, 1,
                   doc="Ends what is under way and arms anew; refused by the divider, it only ends. "
                       "While busy it is done afterwards; the last write counts.")
        disarm: Field(action.W, 1, doc="Ends what is under way. Wins over arm.")

    class Status(Register, access="r"):
        """State of the line, at most 240 ns old."""
        armed: Field(action.R, 1, doc="Waiting for the reference edge.")
        active: Field(action.R, 1, doc="The edge was crossed; SYNC is on.")
        late: Field(action.R, 1, doc="The last arming was at or past its reference, and does not fire.")
        busy: Field(action.R, 1, doc="A write to Control has not had its effect on this register yet.")

    class Interrupt(Register, access="rw"):
        """Events of the line; the interrupt is on while any is set.  The divider's results are valid with them."""
        started: Field(action.RW1C, 1, doc="The reference edge was crossed. Write 1 to clear.")
        finished: Field(action.RW1C, 1, doc="The last pixel of the line was reached. Write 1 to clear.")
        late: Field(action.RW1C, 1, doc="An arming was at or past its reference. Write 1 to clear.")

    def __init__(self):
        self._registers = RegisterBank(addr_width=3)
        self._config = self._registers.add(self.Config, offset=0x00)
        self._reference = self._registers.add(self.Reference, offset=0x04)
        self._control = self._registers.add(self.Control, offset=0x08)
        self._status = self._registers.add(self.Status, offset=0x0c)
        self._interrupt = self._registers.add(self.Interrupt, offset=0x10)
        memory_map = self._registers.finish()
        super().__init__({
            "bus": In(self._registers.bus_signature), "settings": Out(CompareSettings),
            "arm": Out(1), "disarm": Out(1),
            "armed": In(1), "active": In(1), "late": In(1), "busy": In(1),
            "started": In(1), "finished": In(1), "went_late": In(1), "interrupt": Out(1),
        })
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        config, control = self._config.f, self._control.f
        status, events = self._status.f, self._interrupt.f
        m.d.comb += [
            self.settings.axis.eq(config.axis.data), self.settings.reverse.eq(config.reverse.data),
            self.settings.reference.eq(self._reference.f.value.data),
            self.arm.eq(control.arm.w_stb & control.arm.w_data),
            self.disarm.eq(control.disarm.w_stb & control.disarm.w_data),
            status.armed.r_data.eq(self.armed), status.active.r_data.eq(self.active),
            status.late.r_data.eq(self.late), status.busy.r_data.eq(self.busy),
            events.started.set.eq(self.started), events.finished.set.eq(self.finished),
            events.late.set.eq(self.went_late),
            self.interrupt.eq(events.started.data | events.finished.data | events.late.data),
        ]
        return m
