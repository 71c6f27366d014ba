# SPDX-License-Identifier: BSD-2-Clause
"""On-chip memory: a boot region the program cannot write, and RAM, each with one port for either bus."""

from pathlib import Path

from amaranth import ClockSignal, Const, Instance, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import exact_log2

import rtl.registers  # finds amaranth_soc  # noqa: F401
from amaranth_soc import wishbone
from amaranth_soc.memory import MemoryMap

__all__ = ["OnChipMemory", "Region", "VERILOG"]

VERILOG = Path(__file__).with_name("memory.v")
"""The memory array itself: simulation loads it, synthesis makes block RAM of it."""


class Region:
    """A run of addresses backed by one memory array.

    Parameters
    ----------
    name : str
    plusarg : str
        Loads it in simulation: ``+<plusarg>=<hex file>``.
    address, size : int
        In bytes; ``size`` is a power of two and ``address`` a multiple of half of it or more.
    writable : bool
        The data bus may write it.
    """

    def __init__(self, name, *, plusarg, address, size, writable):
        if size & (size - 1) or address % (size // 2):
            raise ValueError(f"region {name} must have a power of two as size and start at a multiple of half "
                             f"of it, not {size:#x} bytes at {address:#x}")
        self.name, self.plusarg, self.address, self.size, self.writable = name, plusarg, address, size, writable

    def holds(self, address):
        """Whether the byte ``address`` lies in it, as a value."""
        half_bits = exact_log2(self.size // 2)
        first = self.address >> half_bits
        return ((address >> half_bits) == first) | ((address >> half_bits) == first + 1)


class BusPort(wiring.Component):
    """One bus's way into the regions.  Domain ``sync``.

    A single access takes 2 clocks, the first word of an incrementing burst 2 and each further one 1: a cache
    line of 8 words takes 9 clocks, always.  An address outside every region, and a write to a region that is
    not writable, is answered with ``err`` after 2 clocks.

    Members
    -------
    bus : In
        Wishbone with ``err``, ``cti`` and ``bte`` (linear bursts only).
    enable : Out(1), per region
        Access now.
    address : Out
        Word address, not yet reduced to a region's size.
    write : Out(4)
        Bytes to write.
    data : In(32), per region
    """

    def __init__(self, regions, signature):
        self._regions = regions
        members = {"bus": In(signature), "address": Out(signature.addr_width), "write": Out(4)}
        for region in regions:
            members |= {f"{region.name}_enable": Out(1), f"{region.name}_data": In(32)}
        super().__init__(members)

    def elaborate(self, platform):
        m = Module()
        bus = self.bus
        access = bus.cyc & bus.stb
        streaming = bus.ack & (bus.cti == wishbone.CycleType.INCR_BURST)
        fetch = access & ~bus.err & (~bus.ack | streaming)
        m.d.comb += [
            self.address.eq(bus.adr + streaming),
            self.write.eq(Mux(bus.we, bus.sel, 0)),
        ]
        allowed = Const(0)
        for region in self._regions:
            # By the address of the bus, not of the fetch: a burst never leaves its line.
            here = region.holds(bus.adr << 2) & (1 if region.writable else ~bus.we)
            allowed |= here
            chosen = Signal(name=f"{region.name}_chosen")
            enable = getattr(self, f"{region.name}_enable")
            m.d.comb += enable.eq(fetch & here)
            m.d.sync += chosen.eq(here)
            with m.If(chosen):
                m.d.comb += bus.dat_r.eq(getattr(self, f"{region.name}_data"))
        m.d.sync += [
            bus.ack.eq(fetch & allowed),
            bus.err.eq(fetch & ~allowed),
        ]
        return m


class OnChipMemory(wiring.Component):
    """All on-chip memory behind the instruction and the data bus, which never wait for each other.

    Domain ``sync``.  Timing and errors: :class:`BusPort`.  The instruction bus must fetch after the data bus
    has written, not meanwhile (firmware: ``fence.i``).

    Parameters
    ----------
    regions : list of Region
    addr_width : int
        Bits of a byte address; regions must fit.
    """

    def __init__(self, regions, *, addr_width):
        self.regions = regions
        self._signature = wishbone.Signature(addr_width=addr_width - 2, data_width=32, granularity=8,
                                             features={"err", "cti", "bte"})
        super().__init__({"ibus": In(self._signature), "dbus": In(self._signature)})
        self.dbus.memory_map = MemoryMap(addr_width=addr_width, data_width=8)
        self.ibus.memory_map = MemoryMap(addr_width=addr_width, data_width=8)

    def elaborate(self, platform):
        m = Module()
        ports = {}
        for name in ("ibus", "dbus"):
            ports[name] = m.submodules[name] = BusPort(self.regions, self._signature)
            wiring.connect(m, wiring.flipped(getattr(self, name)), ports[name].bus)
        a, b = ports["ibus"], ports["dbus"]
        for region in self.regions:
            width = exact_log2(region.size // 4)
            # Where a region starts in the middle of its own size, its two halves are the other way round.
            swap = (region.address // (region.size // 2) & 1) << (width - 1)
            m.submodules[region.name] = Instance(
                "abbe_memory", p_WORDS=region.size // 4, p_ADDRESS_WIDTH=width, p_FILE=region.plusarg + "=%s",
                p_CONTENTS=region.name + ".hex",
                i_clk=ClockSignal("sync"),
                i_a_enable=getattr(a, f"{region.name}_enable"), i_a_address=a.address[:width] ^ swap,
                o_a_data=getattr(a, f"{region.name}_data"),
                i_b_enable=getattr(b, f"{region.name}_enable"), i_b_address=b.address[:width] ^ swap,
                i_b_write=b.write if region.writable else Const(0, 4), i_b_write_data=b.bus.dat_w,
                o_b_data=getattr(b, f"{region.name}_data"),
            )
        return m
