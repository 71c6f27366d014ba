# SPDX-License-Identifier: BSD-2-Clause
"""Snapshot: the position of all axes and the time, latched on one clock, and their registers.

Two banks, so that the servo tick and the program never disturb each other: ``Tick...``, latched by the servo
tick, and ``Sample...``, latched by a write to ``Control``.  A third bank belongs here when there is a trigger
pin: latched in ``fast`` by the pin itself, without a crossing on the way in, it feeds a FIFO whose other port
is in ``sync``; it takes the same ``positions`` and ``time`` that are latched here.
"""

from amaranth import Cat, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.crossing import Latch
from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["AXES", "LATCH_LATENCY", "SnapshotPeripheral", "Timestamp"]

AXES = 4

LATCH_LATENCY = 4
"""``fast`` clock edges from the ``sync`` edge that takes a request to the edge that latches."""

HALF = (1 << 16) - 1
LAST = (1 << 32) - 1


class Timestamp(wiring.Component):
    """Count the clocks of ``fast``, 64 bits wide without a 64-bit carry.

    Parameters
    ----------
    init : int
        Value at reset.

    Members
    -------
    time : Out(64)
        Rises by one at each clock; wraps.
    """

    def __init__(self, *, init=0):
        if not isinstance(init, int) or not 0 <= init < 1 << 64:
            raise ValueError(f"a time has 64 bits, not {init!r}")
        # Looked up one clock ahead: the low word is at its last value.  ``near``: its upper half was so one clock ago.
        self._carry, self._near = Signal(init=init & LAST == LAST), Signal(init=init & LAST > LAST - HALF)
        super().__init__({"time": Out(64, init=init)})

    def elaborate(self, platform):
        m = Module()
        low, high = self.time[:32], self.time[32:]
        m.d.fast += [
            self._near.eq(low[16:].all()), self._carry.eq(self._near & (low[:16] == HALF - 1)), low.eq(low + 1),
        ]
        with m.If(self._carry):
            m.d.fast += high.eq(high + 1)
        return m


class SnapshotPeripheral(wiring.Component):
    """All axes at one instant on the register bus.  Registers are the nested classes, in address order.

    A request taken by ``sync`` clock 0 latches all ``positions`` and the time together at the 4th ``fast`` edge
    after it (:data:`LATCH_LATENCY`; 5th when the synchroniser resolves late), and is readable 2 ``sync`` edges
    after that (3 when late).  With ``fast`` at 4 times ``sync``: readable after the 2nd or 3rd ``sync`` edge,
    by the phase, and 1 or 2 later when late.

    A position is that of the pins 3 ``fast`` clocks before (and as many as the axis's filter has samples).

    Parameters
    ----------
    axes : int
        1 to 4; otherwise :exc:`ValueError`.  Positions of axes beyond read 0.
    time_init : int
        Time at reset.

    Members
    -------
    positions : In(signed(32)).array(axes), fast
        Counts of the axes.
    time : Out(64), fast
        Clocks of ``fast`` since reset.
    tick : In(1), sync
        Strobe: latch the tick bank.
    tick_done : Out(1), sync
        One-clock strobe: the tick bank is readable as of this clock and until the next ``tick``.
    sample : Out(1), fast
        One-clock strobe: the sample bank is latched at the end of this clock.  What other blocks latch by it
        is readable with it.
    """

    class Control(Register, access="w"):
        """Requests."""
        sample: Field(action.W, 1, doc="Write 1: latch the sample bank, and the diagnostics of "
                                       "all encoder axes.")

    class Status(Register, access="r"):
        """Progress of the sample bank."""
        busy: Field(action.R, 1, doc="From the write of sample until the sample bank is readable; "
                                     "do not read the bank meanwhile.")

    class TickTimeLow(Register, access="r"):
        """Time of the last servo tick, low word."""
        value: Field(action.R, 32, unit="fast clocks", doc="Bits 0 to 31 of the clocks since reset.")

    class TickTimeHigh(Register, access="r"):
        """Time of the last servo tick, high word."""
        value: Field(action.R, 32, unit="fast clocks", doc="Bits 32 to 63 of the clocks since reset.")

    class TickPosition(Register, access="r"):
        """Position of one axis at the last servo tick."""
        value: Field(action.R, signed(32), unit="counts", doc="Latched together with all axes and the time.")

    class SampleTimeLow(Register, access="r"):
        """Time of the last sample, low word."""
        value: Field(action.R, 32, unit="fast clocks", doc="Bits 0 to 31 of the clocks since reset.")

    class SampleTimeHigh(Register, access="r"):
        """Time of the last sample, high word."""
        value: Field(action.R, 32, unit="fast clocks", doc="Bits 32 to 63 of the clocks since reset.")

    class SamplePosition(Register, access="r"):
        """Position of one axis at the last sample."""
        value: Field(action.R, signed(32), unit="counts", doc="Latched together with all axes and the time.")

    def __init__(self, *, axes=4, time_init=0):
        if not isinstance(axes, int) or not 1 <= axes <= AXES:
            raise ValueError(f"a snapshot has 1 to {AXES} axes, not {axes!r}")
        self._axes = axes
        self._timestamp = Timestamp(init=time_init)
        self._registers = registers = RegisterBank(addr_width=4)
        self._control = registers.add(self.Control, offset=0x00)
        self._status = registers.add(self.Status, offset=0x04)
        self._tick = [
            registers.add(self.TickTimeLow, offset=0x08), registers.add(self.TickTimeHigh, offset=0x0c),
            *(registers.add(self.TickPosition, offset=0x10 + 4 * n, name=f"tick_position{n}")
              for n in range(AXES)),
        ]
        self._sample = [
            registers.add(self.SampleTimeLow, offset=0x20), registers.add(self.SampleTimeHigh, offset=0x24),
            *(registers.add(self.SamplePosition, offset=0x30 + 4 * n, name=f"sample_position{n}")
              for n in range(AXES)),
        ]
        memory_map = registers.finish()
        super().__init__({
            "bus": In(registers.bus_signature), "positions": In(signed(32)).array(axes), "time": Out(64),
            "tick": In(1), "tick_done": Out(1), "sample": Out(1),
        })
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        m.submodules.timestamp = self._timestamp
        m.d.comb += self.time.eq(self._timestamp.time)

        # In the order of the registers of a bank: time low, time high, positions.
        now = Cat(self.time, *self.positions)
        for name, bank in ("tick", self._tick), ("sample", self._sample):
            latch = Latch(len(now), source="fast", reader="sync")
            m.submodules[name] = latch
            m.d.comb += latch.i.eq(now)
            for n, register in enumerate(bank[:2 + self._axes]):
                m.d.comb += register.f.value.r_data.eq(latch.o.word_select(n, 32))

        tick, sample = m.submodules.tick, m.submodules.sample
        request = self._control.f.sample
        m.d.comb += [
            tick.request.eq(self.tick), self.tick_done.eq(tick.done),
            sample.request.eq(request.w_stb & request.w_data), self.sample.eq(sample.capture),
            # Busy at once, so that a read right behind the write cannot miss it.
            self._status.f.busy.r_data.eq(sample.request | sample.busy),
        ]
        return m
