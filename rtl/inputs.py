# SPDX-License-Identifier: BSD-2-Clause
"""The slow inputs: limit switches, emergency stop, TTL inputs with their edges, DIP switches."""

from amaranth import Module, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, connect, flipped

from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["InputsPeripheral"]

DIP_SWITCHES = 4


class InputsPeripheral(wiring.Component):
    """Input pins as registers.  Domain ``sync``; a level that clock 0 samples is what a read strobe taken by clock 2
    finds (2 flip-flops, of which the first samples), and its edge what one taken by clock 3 finds.

    Switches are not debounced.  Edges of the TTL inputs are kept until they are cleared, down to pulses of one
    clock, and stamped with the clock after which their level is readable.

    Members
    -------
    limit_lower, limit_upper : In(4)
        One bit per axis, asynchronous; 1 = closed, the axis is at its limit.
    estop, in0, in1 : In(1)
        Asynchronous.
    dip : In(4)
        Asynchronous; 1 = on.
    count : In(32)
        Time, for stamps: the timer's.
    """

    class Levels(Register, access="r"):
        """The pins, synchronised."""
        limit_lower: Field(action.R, 4, doc="Bit n: axis n is at its lower limit.")
        limit_upper: Field(action.R, 4, doc="Bit n: axis n is at its upper limit.")
        estop: Field(action.R, 1, doc="The emergency stop holds the drives off.")
        in0: Field(action.R, 1, doc="TTL input IN0.")
        in1: Field(action.R, 1, doc="TTL input IN1.")
        dip: Field(action.R, DIP_SWITCHES, doc="Bit n: switch n is on.")

    class Edges(Register, access="rw"):
        """What the TTL inputs did."""
        in0_rose: Field(action.RW1C, 1, doc="IN0 went high. Write 1 to clear.")
        in0_fell: Field(action.RW1C, 1, doc="IN0 went low. Write 1 to clear.")
        in1_rose: Field(action.RW1C, 1, doc="IN1 went high. Write 1 to clear.")
        in1_fell: Field(action.RW1C, 1, doc="IN1 went low. Write 1 to clear.")

    class In0Time(Register, access="r"):
        """When IN0 changed."""
        value: Field(action.R, unsigned(32), unit="clocks", doc="The timer's Count at the last edge, either way.")

    class In1Time(Register, access="r"):
        """When IN1 changed."""
        value: Field(action.R, unsigned(32), unit="clocks", doc="The timer's Count at the last edge, either way.")

    def __init__(self):
        self._registers = registers = RegisterBank(addr_width=2)
        self._levels = registers.add(self.Levels, offset=0x0)
        self._edges = registers.add(self.Edges, offset=0x4)
        self._times = {"in0": registers.add(self.In0Time, offset=0x8), "in1": registers.add(self.In1Time, offset=0xc)}
        memory_map = registers.finish()
        super().__init__({
            "bus": In(registers.bus_signature),
            "limit_lower": In(4), "limit_upper": In(4), "estop": In(1), "in0": In(1), "in1": In(1),
            "dip": In(DIP_SWITCHES), "count": In(32),
        })
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        for name, _field, _bit in self.Levels.layout():
            pin = getattr(self, name)
            level = Signal.like(pin, name=name + "_level")
            m.submodules[f"{name}_sync"] = FFSynchronizer(pin, level)
            m.d.comb += getattr(self._levels.f, name).r_data.eq(level)
            if name in self._times:
                self._watch(m, name, level)
        return m

    def _watch(self, m, name, level):
        was, time = Signal(name=f"{name}_was"), Signal(32, name=f"{name}_time")
        m.d.sync += was.eq(level)
        with m.If(level != was):
            m.d.sync += time.eq(self.count)
        m.d.comb += [
            getattr(self._edges.f, f"{name}_rose").set.eq(level & ~was),
            getattr(self._edges.f, f"{name}_fell").set.eq(~level & was),
            self._times[name].f.value.r_data.eq(time),
        ]
