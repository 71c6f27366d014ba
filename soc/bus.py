# SPDX-License-Identifier: BSD-2-Clause
"""From the processor's data bus to registers: the bridge, the time-out, and the record of refused writes."""

from amaranth import Module, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.registers import BUS_WIDTH, Field, Register, RegisterBank, action, csr
from amaranth_soc import wishbone
from amaranth_soc.memory import MemoryMap

__all__ = ["BusFaultPeripheral", "BusTimeout", "RegisterBridge"]


class RegisterBridge(wiring.Component):
    """32-bit Wishbone to 32-bit CSR bus.  Domain ``sync``.

    Every access takes 2 clocks: strobe and register on the first, ``ack`` and data on the second.  An access
    narrower than a word and an address without a register get ``err`` in place of ``ack``, touching nothing.

    Parameters
    ----------
    csr_bus : :class:`csr.Interface`
        The decoder's bus; its memory map must be complete.

    Members
    -------
    bus : In
        Wishbone, 32 bits, granularity 8, with ``err``.
    csr : Out
    """

    def __init__(self, csr_bus):
        memory_map = csr_bus.memory_map
        self._addresses = sorted(info.start for info in memory_map.all_resources())
        super().__init__({
            "bus": In(wishbone.Signature(addr_width=csr_bus.addr_width, data_width=BUS_WIDTH, granularity=8,
                                         features={"err"})),
            "csr": Out(csr.Signature(addr_width=csr_bus.addr_width, data_width=BUS_WIDTH)),
        })
        self.bus.memory_map = MemoryMap(addr_width=csr_bus.addr_width + 2, data_width=8)
        self.csr.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        mapped = Signal()
        with m.Switch(self.bus.adr):
            with m.Case(*self._addresses):
                m.d.comb += mapped.eq(1)
        first = self.bus.cyc & self.bus.stb & ~self.bus.ack & ~self.bus.err
        good = mapped & self.bus.sel.all()
        m.d.comb += [
            self.csr.addr.eq(self.bus.adr),
            self.csr.w_data.eq(self.bus.dat_w),
            self.csr.r_stb.eq(first & good & ~self.bus.we),
            self.csr.w_stb.eq(first & good & self.bus.we),
            self.bus.dat_r.eq(self.csr.r_data),
        ]
        m.d.sync += [self.bus.ack.eq(first & good), self.bus.err.eq(first & ~good)]
        return m


class BusTimeout(wiring.Component):
    """Ends an access that nobody answers.  Domain ``sync``; adds no clock to one that is answered.

    ``err`` rises ``clocks`` clocks after the strobe if ``ack`` or ``err`` has not, for one clock.

    Parameters
    ----------
    signature : :class:`wishbone.Signature`
        With ``err``.
    clocks : int
        Patience, at least 2.
    """

    def __init__(self, signature, *, clocks=16):
        if clocks < 2:
            raise ValueError(f"clocks must be at least 2, not {clocks!r}")
        self._signature, self._clocks = signature, clocks
        super().__init__({"initiator": In(signature), "target": Out(signature)})

    def elaborate(self, platform):
        m = Module()
        expired = Signal()
        waited = Signal(range(self._clocks))
        for name, member in self._signature.members.items():
            initiator, target = getattr(self.initiator, name), getattr(self.target, name)
            if name not in ("stb", "err"):
                m.d.comb += target.eq(initiator) if member.flow is Out else initiator.eq(target)
        # The target sees the access end on the clock on which the initiator does.
        m.d.comb += [self.target.stb.eq(self.initiator.stb & ~expired),
                     self.initiator.err.eq(self.target.err | expired)]

        open_ = self.initiator.cyc & self.initiator.stb & ~self.initiator.ack & ~self.initiator.err
        m.d.sync += expired.eq(open_ & (waited == self._clocks - 1))
        with m.If(open_):
            m.d.sync += waited.eq(waited + 1)
        with m.Else():
            m.d.sync += waited.eq(0)
        return m


class BusFaultPeripheral(wiring.Component):
    """Refused writes, on the CSR bus.  Domain ``sync``.

    A load that fails traps at once; a store is posted and cannot, so a refused one is kept here and interrupts.

    Members
    -------
    watch : In
        The data bus at the processor, observed.
    interrupt : Out(1)
        High while ``Fault.write`` is set.
    """

    class Fault(Register, access="rw"):
        """A write that no one took; a set bit holds the interrupt line."""
        write: Field(action.RW1C, 1, doc="A write ended with a bus error and was lost. Write 1 to clear.")

    class Address(Register, access="r"):
        """Where it went."""
        value: Field(action.R, unsigned(32), doc="Address of the first refused write since Fault was cleared, "
                                                 "rounded down to a word.")

    def __init__(self, signature):
        self._registers = RegisterBank(addr_width=1)
        self._fault = self._registers.add(self.Fault, offset=0)
        self._address = self._registers.add(self.Address, offset=4)
        memory_map = self._registers.finish()
        members = {"bus": In(self._registers.bus_signature), "interrupt": Out(1)}
        members |= {name: In(member.shape) for name, member in signature.members.items()
                    if name in ("cyc", "stb", "we", "err", "adr")}
        super().__init__(members)
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        refused = self.cyc & self.stb & self.we & self.err
        address = Signal(32)
        m.d.comb += [
            self._fault.f.write.set.eq(refused),
            self._address.f.value.r_data.eq(address),
            self.interrupt.eq(self._fault.f.write.data),
        ]
        with m.If(refused & ~self._fault.f.write.data):
            m.d.sync += address.eq(self.adr << 2)
        return m
