# SPDX-License-Identifier: BSD-2-Clause
"""What forces the motor drives off with no help from the processor."""

from amaranth import Cat, Module, Mux, Signal, signed, unsigned
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.monitor import STEP_BITS, Budget, CountSampler, Following, Overspeed, Progress
from rtl.registers import Field, Register, RegisterBank, action, snake_case

__all__ = ["AXES", "AXIS_FAULTS", "FaultLatch", "InterlockPeripheral"]

AXES = 4

AXIS_FAULTS = "illegal", "no_progress", "over_speed", "following"
"""Faults of one axis, in the order of their bits: bit ``AXES * fault + axis``."""

ALL_FAULTS = *AXIS_FAULTS, "watchdog", "estop"
WATCHDOG, ESTOP = AXES * len(AXIS_FAULTS), AXES * len(AXIS_FAULTS) + 1
FAULTS = ESTOP + 1


class FaultLatch(wiring.Component):
    """Keeps faults and forces drives off.  Domain ``sync``.

    A fault is kept from the clock after its ``cause``, and cleared in a clock with ``clear`` and without ``cause``.
    Kept ones of an axis hold that axis off; that of the watchdog holds all off.  The emergency stop is a level: it holds
    all off for as long as it lasts; kept, it says that it has been.

    Members
    -------
    cause, clear : In(FAULTS)
    faults : Out(FAULTS)
        The kept ones, from flip-flops.
    inhibit : Out(AXES)
        Hold this axis off: an axis' cause or the watchdog's shows 1 clock later, the emergency stop's at once.
    """

    cause: In(FAULTS)
    clear: In(FAULTS)
    faults: Out(FAULTS)
    inhibit: Out(AXES)

    def elaborate(self, platform):
        m = Module()
        m.d.sync += self.faults.eq((self.faults & ~self.clear) | self.cause)
        everything = self.faults[WATCHDOG] | self.cause[ESTOP]
        for axis in range(AXES):
            m.d.comb += self.inhibit[axis].eq(everything | self.faults[axis:WATCHDOG:AXES].any())
        return m


class InterlockPeripheral(wiring.Component):
    """The interlock on the register bus.  Domain ``sync``; of ``fast`` it takes samples of the counts.

    The conditions are those of :mod:`rtl.monitor`, each of every axis; what follows from them is :class:`FaultLatch`'s.
    The processor gives limits and clears; between a condition and a pin there is nothing of it.

    Members
    -------
    estop : In(1)
        Pin, asynchronous; 1 = drives off.  A level that clock 0 samples shows in ``inhibit`` after clock 1
        (2 flip-flops, of which the first samples).
    expired : In(1)
        Strobe of the watchdog.
    illegal : In(AXES)
        Strobes: an encoder made an illegal transition.
    low : In(STEP_BITS).array(AXES), fast
        Lowest bits of the counts.
    drive : In(signed(13)).array(AXES)
        Present drives, clocks of 2500 with their direction.
    inhibit : Out(AXES)
        Hold this axis off.  All ones after reset, until ``estop`` has been seen low.
    """

    class Faults(Register, access="r"):
        """Faults that are kept. Bit n of a field: axis n, which is held off."""
        illegal: Field(action.R, AXES, doc="More illegal transitions than IllegalMost within IllegalTime.")
        no_progress: Field(action.R, AXES, doc="Driven, and the count made no way.")
        over_speed: Field(action.R, AXES, doc="More counts in a window of 100 us than SpeedMost.")
        following: Field(action.R, AXES, doc="Armed, and further than FollowingMost from Expected.")
        watchdog: Field(action.R, 1, doc="The processor was reset, by the watchdog or by order: all axes are held off.")
        estop: Field(action.R, 1, doc="The emergency stop has been active. Holds nothing off: the stop itself does.")

    class Causes(Register, access="r"):
        """What of the same is so at present."""
        illegal: Field(action.R, AXES, doc="Until IllegalTime is over.")
        no_progress: Field(action.R, AXES, doc="Until way is made, or the drive is less; so not for long.")
        over_speed: Field(action.R, AXES, doc="As of the last whole window.")
        following: Field(action.R, AXES, doc="As of the last sample.")
        watchdog: Field(action.R, 1, doc="For one clock.")
        estop: Field(action.R, 1, doc="The emergency stop holds all drives off.")

    class Clear(Register, access="w"):
        """Faults to forget; those with a cause stay."""
        illegal: Field(action.W, AXES, doc="Bit n of 1: clear.")
        no_progress: Field(action.W, AXES, doc="Bit n of 1: clear.")
        over_speed: Field(action.W, AXES, doc="Bit n of 1: clear.")
        following: Field(action.W, AXES, doc="Bit n of 1: clear.")
        watchdog: Field(action.W, 1, doc="1: clear.")
        estop: Field(action.W, 1, doc="1: clear.")

    class Control(Register, access="rw"):
        """How axes are watched."""
        armed: Field(action.RW, AXES, doc="Bit n: axis n is to follow Expected.")
        hold: Field(action.RW, AXES, doc="Bit n: axis n may stand at any drive, as it does that holds a load. Progress is "
                                         "asked for where its drive is HeldMost from the mean with which it last moved.")

    class Way(Register, access="rw"):
        """What progress is."""
        counts: Field(action.RW, unsigned(4), init=2, unit="counts",
                      doc="Way is made when the lowest and the highest count differ by so much. With 1, a single stuck "
                          "wire is progress.")

    class Strong(Register, access="rw"):
        """Strong drive."""
        value: Field(action.RW, unsigned(12), init=1250, unit="clocks of 2500",
                     doc="From this drive on StrongTime counts.")

    class DriveTime(Register, access="rw"):
        """Patience with drive from Breakaway, or HeldMost, on."""
        value: Field(action.RW, unsigned(16), init=38000, unit="0.5 us", doc="Longest time without way.")

    class HeldMost(Register, access="rw"):
        """Breakaway of an axis that holds."""
        value: Field(action.RW, unsigned(12), init=1750, unit="clocks of 2500",
                     doc="Difference of its drive from the mean with which it last moved.")

    class IllegalMost(Register, access="rw"):
        """Illegal transitions that are allowed."""
        value: Field(action.RW, unsigned(8), doc="In IllegalTime. Some that are closer than 0.4 us count as one.")

    class IllegalTime(Register, access="rw"):
        """Time in which illegal transitions count together."""
        value: Field(action.RW, unsigned(16), init=100, unit="100 us", doc="0 is 65536. Taken when the last is over.")

    class StrongTime(Register, access="rw"):
        """Patience with strong drive of one axis."""
        value: Field(action.RW, unsigned(16), init=1920, unit="0.5 us", doc="Longest time without way.")

    class Breakaway(Register, access="rw"):
        """Drive that moves one axis."""
        value: Field(action.RW, unsigned(12), init=380, unit="clocks of 2500",
                     doc="From this drive on DriveTime counts.")

    class SpeedMost(Register, access="rw"):
        """Highest speed of one axis."""
        value: Field(action.RW, unsigned(16), init=70, unit="counts in 100 us", doc="In either direction, net.")

    class FollowingMost(Register, access="rw"):
        """Following error of one axis."""
        value: Field(action.RW, unsigned(31), unit="counts", doc="Largest difference of its count from Expected.")

    class Expected(Register, access="rw"):
        """Where one axis should be."""
        value: Field(action.RW, signed(32), unit="counts", doc="Written at each servo tick.")

    def __init__(self):
        self._registers = registers = RegisterBank(addr_width=5)
        at = {}             # register class: its instance, or those of all axes
        for n, register in enumerate((self.Faults, self.Causes, self.Clear, self.Control, self.Way, self.Strong,
                                      self.DriveTime, self.HeldMost, self.IllegalMost, self.IllegalTime)):
            at[register] = registers.add(register, offset=4 * n)
        for block, register in enumerate((self.StrongTime, self.Breakaway, self.SpeedMost, self.FollowingMost,
                                          self.Expected), 3):
            name = snake_case(register.__name__)
            at[register] = [registers.add(register, offset=16 * block + 4 * n, name=f"{name}{n}") for n in range(AXES)]
        self._at = at
        memory_map = registers.finish()
        self._sampler, self._latch = CountSampler(axes=AXES), FaultLatch()
        super().__init__({
            "bus": In(registers.bus_signature), "estop": In(1), "expired": In(1), "illegal": In(AXES),
            "low": In(STEP_BITS).array(AXES), "drive": In(signed(13)).array(AXES), "inhibit": Out(AXES),
        })
        self.bus.memory_map = memory_map

    def _value(self, register, axis=None):
        at = self._at[register]
        return (at if axis is None else at[axis]).f.value.data

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        m.submodules.sampler = sampler = self._sampler
        m.submodules.latch = latch = self._latch
        estop = Signal(init=1)
        # Resets to 1: no drive moves before the pin has been looked at.
        m.submodules.estop_sync = FFSynchronizer(self.estop, estop, init=1, reset_less=False)
        causes = {name: Signal(AXES, name=name) for name in AXIS_FAULTS}
        for axis in range(AXES):
            m.d.comb += sampler.low[axis].eq(self.low[axis])
            self._watch(m, axis, causes)

        def fields(register):
            return [getattr(self._at[register].f, name) for name in ALL_FAULTS]

        m.d.comb += [
            latch.cause.eq(Cat(*causes.values(), self.expired, estop)), self.inhibit.eq(latch.inhibit),
            latch.clear.eq(Cat(*(Mux(field.w_stb, field.w_data, 0) for field in fields(self.Clear)))),
            Cat(*(field.r_data for field in fields(self.Faults))).eq(latch.faults),
            Cat(*(field.r_data for field in fields(self.Causes))).eq(latch.cause),
        ]
        return m

    def _watch(self, m, axis, causes):
        """The four detectors of one axis."""
        sampler, control = self._sampler, self._at[self.Control].f
        m.submodules[f"illegal{axis}"] = illegal = Budget()
        m.submodules[f"progress{axis}"] = progress = Progress()
        m.submodules[f"over_speed{axis}"] = speed = Overspeed()
        m.submodules[f"following{axis}"] = following = Following()
        limits = progress.limits
        m.d.comb += [
            illegal.event.eq(self.illegal[axis]), illegal.window.eq(sampler.window),
            illegal.most.eq(self._value(self.IllegalMost)), illegal.length.eq(self._value(self.IllegalTime)),
            progress.stb.eq(sampler.stb), progress.window.eq(sampler.window), progress.step.eq(sampler.steps[axis]), progress.drive.eq(self.drive[axis]),
            progress.hold.eq(control.hold.data[axis]),
            limits.way.eq(self._at[self.Way].f.counts.data), limits.strong.eq(self._value(self.Strong)),
            limits.strong_samples.eq(self._value(self.StrongTime, axis)), limits.samples.eq(self._value(self.DriveTime)),
            limits.breakaway.eq(self._value(self.Breakaway, axis)), limits.held.eq(self._value(self.HeldMost)),
            speed.stb.eq(sampler.stb), speed.window.eq(sampler.window), speed.step.eq(sampler.steps[axis]),
            speed.limit.eq(self._value(self.SpeedMost, axis)),
            following.count.eq(sampler.counts[axis]), following.expected.eq(self._value(self.Expected, axis)),
            following.most.eq(self._value(self.FollowingMost, axis)), following.armed.eq(control.armed.data[axis]),
        ]
        for name, detector in zip(AXIS_FAULTS, (illegal, progress, speed, following)):
            m.d.comb += causes[name][axis].eq(detector.fault)
