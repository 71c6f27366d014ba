# SPDX-License-Identifier: BSD-2-Clause
"""Levels of the slow inputs: limit switches, emergency stop, TTL inputs."""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, connect, flipped

from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["InputsPeripheral"]


class InputsPeripheral(wiring.Component):
    """Input pins as one register.  Domain ``sync``; a level that clock 0 samples is what a read strobe taken by clock 2
    finds (2 flip-flops, of which the first samples).

    Levels only: switches are debounced by firmware, and an edge that matters in time has its own block.

    Members
    -------
    limit_lower, limit_upper : In(4)
        One bit per axis, asynchronous; 1 = closed, the axis is at its limit.
    estop, in0, in1 : In(1)
        Asynchronous.
    """

    class Levels(Register, access="r"):
        """The pins, synchronised."""
        limit_lower: Field(action.R, 4, doc="Bit n: axis n is at its lower limit.")
        limit_upper: Field(action.R, 4, doc="Bit n: axis n is at its upper limit.")
        estop: Field(action.R, 1, doc="The emergency stop holds the drives off.")
        in0: Field(action.R, 1, doc="TTL input IN0.")
        in1: Field(action.R, 1, doc="TTL input IN1.")

    def __init__(self):
        self._registers = RegisterBank(addr_width=1)
        self._levels = self._registers.add(self.Levels, offset=0)
        memory_map = self._registers.finish()
        super().__init__({
            "bus": In(self._registers.bus_signature),
            "limit_lower": In(4), "limit_upper": In(4), "estop": In(1), "in0": In(1), "in1": In(1),
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
        return m
