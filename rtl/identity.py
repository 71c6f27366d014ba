# SPDX-License-Identifier: BSD-2-Clause
"""Who this gateware is: firmware reads it first and refuses a register map it does not know."""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, connect, flipped

from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["IdentityPeripheral", "MAGIC", "MAP_VERSION"]

MAGIC = 0x41626265
"""``Abbe`` in ASCII, most significant byte first."""

MAP_VERSION = 6
"""Version of the register map; raised whenever a register changes its meaning."""


class IdentityPeripheral(wiring.Component):
    """Constants that name the gateware, on the CSR bus.  Domain ``sync``.

    Parameters
    ----------
    clock_hz, fast_clock_hz : int
        Frequencies of the domains ``sync`` and ``fast``.
    build_id : int
        32 bits that name the design; see :func:`soc.verilog.build_id`.
    """

    class Magic(Register, access="r"):
        """Proof that registers are where firmware thinks they are."""
        value: Field(action.R, 32, doc="0x41626265, \"Abbe\" in ASCII.")

    class MapVersion(Register, access="r"):
        """Version of the register map."""
        value: Field(action.R, 32, doc="Firmware refuses a version it was not built for.")

    class BuildId(Register, access="r"):
        """Name of this very design."""
        value: Field(action.R, 32, doc="First 32 bits of a SHA-256 over the design; equal designs have "
                                       "equal numbers.")

    class ClockHz(Register, access="r"):
        """Frequency of the processor, the bus and the PWM."""
        value: Field(action.R, 32, unit="Hz", doc="Domain sync.")

    class FastClockHz(Register, access="r"):
        """Frequency of everything with an edge in time."""
        value: Field(action.R, 32, unit="Hz", doc="Domain fast.")

    def __init__(self, *, clock_hz, fast_clock_hz, build_id=0):
        self._values = {
            self.Magic: MAGIC, self.MapVersion: MAP_VERSION, self.BuildId: build_id,
            self.ClockHz: clock_hz, self.FastClockHz: fast_clock_hz,
        }
        for register, value in self._values.items():
            if not 0 <= value < 1 << 32:
                raise ValueError(f"{register.__name__} must fit 32 bits, not {value!r}")
        self._registers = RegisterBank(addr_width=4)
        self._instances = [self._registers.add(register, offset=4 * n)
                           for n, register in enumerate(self._values)]
        memory_map = self._registers.finish()
        super().__init__({"bus": In(self._registers.bus_signature)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        for instance, value in zip(self._instances, self._values.values()):
            m.d.comb += instance.f.value.r_data.eq(value)
        return m
