# SPDX-License-Identifier: BSD-2-Clause
"""The processor: VexRiscv (RV32IM, 32 KiB instruction and 16 KiB data cache) from pythondata-cpu-vexriscv.

The netlist is used as it is but for a few lines (:data:`ADAPTATIONS`), because as generated it throws bus
errors away and keeps to itself when it sleeps, and for the size of its caches (:data:`CACHES`).  Each adaptation must
match as often as expected, so another version of the netlist fails at build time instead of misbehaving.
"""

import importlib.util
import re
from pathlib import Path

from amaranth import ClockSignal, Const, Instance, Module, ResetSignal, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

import rtl.registers  # finds amaranth_soc  # noqa: F401
from amaranth_soc import wishbone

__all__ = ["BUS", "Cpu", "netlist"]

BUS = wishbone.Signature(addr_width=30, data_width=32, granularity=8, features={"err", "cti", "bte"})
"""Both buses of the processor: 32-bit words, with byte selects for writes, errors, and line bursts."""

MODULE = "VexRiscv"

ADAPTATIONS = [
    # What the sleep detector needs: wfi holds the pipeline, and which interrupt lines are enabled.
    (r"(output +\[1:0\] +dBusWishbone_BTE,)",
     r"\1\n  output inWfi,\n  output [31:0] interruptMask,"),
    (r"(assign _zz_CsrPlugin_csrMapping_readDataInit_1 = \((\w+) & externalInterruptArray_regNext\);)",
     r"\1\n  assign interruptMask = \2;\n  assign inWfi = CsrPlugin_inWfi;"),
    # An error arrives with the word it belongs to, one clock after the bus, like the word itself.
    (r"assign iBus_rsp_payload_error = 1'b0;",
     "reg iBusWishbone_ERR_regNext;\n  always @(posedge clk) iBusWishbone_ERR_regNext <= iBusWishbone_ERR;\n"
     "  assign iBus_rsp_payload_error = iBusWishbone_ERR_regNext;"),
    (r"assign dBus_rsp_payload_error = 1'b0;",
     "reg dBusWishbone_ERR_regNext;\n  always @(posedge clk) dBusWishbone_ERR_regNext <= dBusWishbone_ERR;\n"
     "  assign dBus_rsp_payload_error = dBusWishbone_ERR_regNext;"),
    # An error on the last word of a line belongs to that line, not to the next one.
    (r"if\(io_mem_rsp_payload_error\) begin(\s+lineLoader_hadError <= 1'b1;)",
     r"if(io_mem_rsp_payload_error && (! lineLoader_fire)) begin\1"),
    # Reads narrower than a word say so too, except in a line burst.
    (r"assign dBusWishbone_SEL = \(\w+ \? dBus_cmd_payload_mask : 4'b1111\);",
     "assign dBusWishbone_SEL = ((dBus_cmd_payload_size == 3'b101) ? 4'b1111 : dBus_cmd_payload_mask);"),
]

CACHES = {"InstructionCache": 15, "DataCache": 14}
"""``log2`` of the bytes of each cache, which the package makes of 4 KiB, direct-mapped, in lines of 32 bytes."""

CACHE_CHANGES = 19, 26
"""Places in the netlist that know the size of each."""

COUNTERS = r"(lineLoader_flushCounter|stageB_flusher_counter)"


def enlarged(text, module, bits):
    """The netlist with one cache of ``2**bits`` bytes, and the number of changes.

    Lines are added; the tags stay as wide as they are, with some bits to spare.  Forgetting all lines (``fence.i``,
    reset) takes a clock for each.
    """
    start = text.index(f"module {module} (")
    end = text.index("endmodule", start)
    line, word = bits - 5, bits - 2                 # bits of an index
    changed, body = 0, text[start:end]
    for pattern, replacement in [
        (r"\[11 : (5|2)\]", rf"[{bits - 1} : \1]"),
        (r"\[0:1023\]", f"[0:{(1 << word) - 1}]"), (r"\[0:127\]", f"[0:{(1 << line) - 1}]"),
        (r"\[9:0\]", f"[{word - 1}:0]"), (r"\[6 ?: ?0\]", f"[{line - 1}:0]"),
        (rf"\[7:0\]( +{COUNTERS};)", rf"[{line}:0]\1"), (rf"{COUNTERS}\[7\]", rf"\1[{line}]"),
        (rf"({COUNTERS} (<=|\+) )8'h", rf"\g<1>{line + 1}'h"),
    ]:
        body, count = re.subn(pattern, replacement, body)
        changed += count
    return text[:start] + body + text[end:], changed


def netlist():
    """Verilog text of the processor, adapted.  Raises :exc:`RuntimeError` if the netlist is not as expected."""
    package = importlib.util.find_spec("pythondata_cpu_vexriscv").submodule_search_locations[0]
    text = (Path(package) / "verilog" / "VexRiscv_Full.v").read_text()
    for pattern, replacement in ADAPTATIONS:
        text, count = re.subn(pattern, replacement, text)
        if count != 1:
            raise RuntimeError(f"the VexRiscv netlist matches {pattern!r} {count} times, not once")
    for (module, bits), expected in zip(CACHES.items(), CACHE_CHANGES, strict=True):
        text, count = enlarged(text, module, bits)
        if count != expected:
            raise RuntimeError(f"{module} of the VexRiscv netlist has {count} places that know its size, not {expected}")
    return text


class Cpu(wiring.Component):
    """The processor in its own clock domain ``cpu``: the same frequency and phase as ``sync``, but it may stop.

    ``asleep`` tells a simulator that the next edge of ``cpu`` would change nothing, so that it may leave it
    out: no clock count and no pin is different for it (the CSR ``mcycle`` counts clocks not left out; measure
    time with the timer block).  The core waits in ``wfi`` with both buses idle and no enabled interrupt pending
    since :data:`SETTLE_CLOCKS` clocks.  It falls in the ``sync`` clock in which an interrupt becomes pending, or
    the reset of ``cpu`` high, before the clock edge that follows.

    Interrupts: the core's own controller, 32 lines, mask in CSR 0xBC0, pending in CSR 0xFC0.

    Parameters
    ----------
    reset_vector : int
        Address of the first instruction.

    Members
    -------
    ibus, dbus : Out(BUS)
        Instruction and data bus.  ``err`` needs no ``ack`` with it.  An error traps: instruction access fault
        (mcause 1) or load access fault (mcause 5).  Stores are posted and their errors do not trap.
    interrupts : In(32)
        Levels, domain ``sync``.
    asleep : Out(1)
        See above.
    """

    SETTLE_CLOCKS = 64
    """Longer than anything the core does beside a held ``wfi``: the longest is a division, 35 clocks."""

    def __init__(self, *, reset_vector=0):
        self._reset_vector = reset_vector
        super().__init__({"ibus": Out(BUS), "dbus": Out(BUS), "interrupts": In(32), "asleep": Out(1)})

    def elaborate(self, platform):
        m = Module()
        in_wfi = Signal()
        mask = Signal(32)
        ports = {
            "i_clk": ClockSignal("cpu"), "i_reset": ResetSignal("cpu"),
            "i_externalResetVector": Const(self._reset_vector, 32),
            "i_timerInterrupt": Const(0), "i_softwareInterrupt": Const(0),
            "i_externalInterruptArray": self.interrupts,
            "o_inWfi": in_wfi, "o_interruptMask": mask,
        }
        for name, bus in (("iBus", self.ibus), ("dBus", self.dbus)):
            prefix = f"{name}Wishbone_"
            ports |= {
                f"o_{prefix}CYC": bus.cyc, f"o_{prefix}STB": bus.stb, f"o_{prefix}WE": bus.we,
                f"o_{prefix}ADR": bus.adr, f"o_{prefix}DAT_MOSI": bus.dat_w, f"o_{prefix}SEL": bus.sel,
                f"o_{prefix}CTI": bus.cti, f"o_{prefix}BTE": bus.bte,
                f"i_{prefix}DAT_MISO": bus.dat_r, f"i_{prefix}ACK": bus.ack | bus.err,
                f"i_{prefix}ERR": bus.err,
            }
        m.submodules.core = Instance(MODULE, **ports)

        pending = (self.interrupts & mask).any()
        quiet = in_wfi & ~self.ibus.cyc & ~self.dbus.cyc & ~pending
        quiet_clocks = Signal(range(self.SETTLE_CLOCKS + 1))
        settled = quiet_clocks == self.SETTLE_CLOCKS
        with m.If(~quiet):
            m.d.cpu += quiet_clocks.eq(0)
        with m.Elif(~settled):
            m.d.cpu += quiet_clocks.eq(quiet_clocks + 1)
        m.d.comb += self.asleep.eq(settled & quiet & ~ResetSignal("cpu"))
        return m
