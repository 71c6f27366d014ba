# SPDX-License-Identifier: BSD-2-Clause
"""A board small enough to be placed and routed in a test: clocks, reset and memories as the product has them."""

from amaranth import ClockDomain, Module, Signal
from amaranth.lib.wiring import Component, In, Out

from soc.ecp5 import ClockGenerator
from soc.memory import OnChipMemory, Region

CONSTRAINTS = '''
FREQUENCY PORT "clk25" 25 MHZ;
LOCATE COMP "clk25" SITE "G2";
IOBUF PORT "clk25" IO_TYPE=LVCMOS33;
LOCATE COMP "reset_button_n" SITE "D6";
IOBUF PORT "reset_button_n" IO_TYPE=LVCMOS33 PULLMODE=UP;
LOCATE COMP "led" SITE "B2";
IOBUF PORT "led" IO_TYPE=LVCMOS33;
'''


class Tiny(Component):
    """Reads a read-only memory with each bus in turn, writes what it finds to the RAM, and shows a bit of it."""

    name, device, package, speed, ecppack = "tiny", "LFE5U-25F", "CABGA381", "6", ()

    clk25: In(1)
    reset_button_n: In(1)
    led: Out(1)

    @staticmethod
    def regions():
        return (Region("boot", plusarg="boot", address=0, size=8 << 10, writable=False),
                Region("ram", plusarg="firmware", address=0x10000, size=16 << 10, writable=True))

    def __init__(self, *, build_id=0):
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        clocks = m.submodules.clocks = ClockGenerator(input_hz=25_000_000, sync_hz=50_000_000, fast_hz=200_000_000)
        m.domains.sync, m.domains.fast = sync, fast = ClockDomain("sync"), ClockDomain("fast")
        m.d.comb += [clocks.oscillator.eq(self.clk25), clocks.request.eq(~self.reset_button_n),
                     sync.clk.eq(clocks.sync_clk), fast.clk.eq(clocks.fast_clk),
                     sync.rst.eq(clocks.reset), fast.rst.eq(clocks.reset)]
        memory = m.submodules.memory = OnChipMemory(self.regions(), addr_width=18)
        address, word, blink = Signal(15), Signal(32), Signal()
        m.d.comb += [
            memory.ibus.cyc.eq(1), memory.ibus.stb.eq(1), memory.ibus.sel.eq(15), memory.ibus.adr.eq(address),
            memory.dbus.cyc.eq(1), memory.dbus.stb.eq(1), memory.dbus.sel.eq(15), memory.dbus.adr.eq(address ^ 5),
            memory.dbus.we.eq(word[0]), memory.dbus.dat_w.eq(word),
        ]
        with m.If(memory.ibus.ack | memory.ibus.err):
            m.d.sync += [address.eq(address + 1), word.eq(word + memory.ibus.dat_r + memory.dbus.dat_r)]
        m.d.fast += blink.eq(~blink)
        m.d.comb += self.led.eq(word.xor() ^ (blink & clocks.safe))
        return m
