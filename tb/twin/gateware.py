# SPDX-License-Identifier: BSD-2-Clause
"""The controller without its processor: all peripherals and the wires between them, behind a data bus at the pins.

What the event-driven model (``gateware.h``) is compared with.
"""

import json

from amaranth import Signal
from amaranth.lib.wiring import connect

from soc import generate
from soc.bus import RegisterBridge
from soc.cpu import BUS
from soc.top import PERIPHERALS, REGISTERS, Abbe
from tb import toolchain
from tb.sim.build import build_model, verilator_root

__all__ = ["Peripherals", "build", "fields"]

TIME_INIT = 0x7fff_ffff_ffe0_0000
"""The time at reset: two million clocks before all bits of its upper word change."""
TIMER_INIT = 0x7fff_ffff_fff8_0000
MILLISECOND_CLOCKS = 500
"""Short, so that presses come in all lengths."""

BUS_PINS = {"bus_address": 32, "bus_write_data": 32, "bus_read_data": 32, "bus_select": 4, "bus_strobe": 1,
            "bus_write": 1, "bus_ack": 1, "bus_err": 1, "interrupts": 32}


class Peripherals(Abbe):
    """:class:`soc.top.Abbe` with the bus of the registers, and the interrupt lines, in place of the processor.

    The bus is that of :class:`soc.bus.RegisterBridge`; ``bus_address`` is in bytes.
    """

    def __init__(self):
        super().__init__(arguments={"snapshot": {"time_init": TIME_INIT}, "timer": {"init": TIMER_INIT},
                                    "buttons": {"millisecond_clocks": MILLISECOND_CLOCKS}})
        for name, width in BUS_PINS.items():
            setattr(self, name, Signal(width, name=name))

    def ports(self):
        """All pins, for :func:`tb.toolchain.to_rtlil`."""
        return [getattr(self, name) for name in (*self.signature.members, *BUS_PINS)]

    def _connect_processor(self, m):
        m.submodules.registers = self._decoder
        m.submodules.bridge = bridge = RegisterBridge(self._decoder.bus)
        connect(m, bridge.csr, self._decoder.bus)
        fault = self._parts["bus"]
        # Elsewhere than among the registers nobody answers; on the real bus that is a time-out.
        inside = self.bus_address[bridge.bus.addr_width + 2:] == REGISTERS >> (bridge.bus.addr_width + 2)
        m.d.comb += [
            bridge.bus.cyc.eq(self.bus_strobe), bridge.bus.stb.eq(self.bus_strobe), bridge.bus.we.eq(self.bus_write),
            bridge.bus.adr.eq(self.bus_address[2:]), bridge.bus.sel.eq(self.bus_select & inside.replicate(4)),
            bridge.bus.dat_w.eq(self.bus_write_data), self.bus_read_data.eq(bridge.bus.dat_r),
            self.bus_ack.eq(bridge.bus.ack), self.bus_err.eq(bridge.bus.err),
            fault.cyc.eq(self.bus_strobe), fault.stb.eq(self.bus_strobe), fault.we.eq(self.bus_write),
            fault.err.eq(bridge.bus.err), fault.adr.eq(self.bus_address[2:]),
        ]
        for p in PERIPHERALS:
            if p.interrupt:
                m.d.comb += self.interrupts[p.interrupt[1]].eq(self._parts[p.part or p.name].interrupt)


def fields():
    """``[(BLOCK_REGISTER_FIELD, address, shift, width, access)]`` of all fields of all registers."""
    table = []
    for block in json.loads(generate.files()["build/generated/registers.json"])["blocks"]:
        for n in range(block["count"]):
            number = n if block["count"] > 1 else ""
            for register in block["registers"]:
                for field in register["fields"]:
                    table.append((f"{block['name']}{number}.{register['name']}.{field['name']}",
                                  block["address"] + n * block["stride"] + register["offset"],
                                  field["shift"], field["width"], field["access"]))
    return table


def write_fields(directory):
    """A file of :func:`fields` for ``lockstep.cpp``, and constants that it needs."""
    path = directory / "fields.txt"
    lines = [f"time {TIME_INIT} 0 0 -", f"timer {TIMER_INIT} 0 0 -", f"millisecond {MILLISECOND_CLOCKS} 0 0 -",
             *(" ".join(map(str, row)) for row in fields())]
    path.write_text("\n".join(lines) + "\n")
    return path


def build():
    """``(program, file of fields)``: the comparison of model and gateware, made if need be."""
    design = Peripherals()
    rtlil = toolchain.to_rtlil(design, name="abbe", ports=design.ports())
    here, board = toolchain.ROOT / "tb" / "twin", toolchain.ROOT / "tb" / "board"
    generated = generate.files()["build/generated/regs.h"]
    directory = toolchain.BUILD / "lockstep" / toolchain.content_key(rtlil)
    with toolchain.cached(directory) as empty:
        if empty:
            toolchain.to_verilog(rtlil, directory / "abbe.v", flatten=True, top="abbe")
    model = build_model(directory / "abbe.v")
    names = ("lockstep", "stimulus", "gateware", "classifier", "flash", "interlock", "led", "line", "pwm", "quadrature", "serial", "trigger")
    sources = [here / f"{name}.cpp" for name in names]
    headers = sorted(here.glob("*.h"))
    include = verilator_root() / "include"
    command = ["g++", "-std=c++17", "-O2", "-Wall", "-Wextra", "-I", ".", "-I", "generated", "-I",
               toolchain.ROOT / "firmware", "-isystem", include, "-isystem", include / "vltstd", "-isystem", model,
               *sources, *(board / name for name in ("adc.cpp", "nor.c")), model / "Vabbe__ALL.a", model / "libverilated.a", "-pthread", "-DVL_TIME_CONTEXT"]
    program = directory / toolchain.content_key(generated, " ".join(map(str, command)), *sources, *headers, board / "nor.h")
    with toolchain.cached(program) as empty:
        if empty:
            (program / "generated").mkdir(exist_ok=True)
            (program / "generated" / "regs.h").write_text(generated)
            toolchain.run([*command, "-o", "lockstep"], cwd=program)
    return program / "lockstep", write_fields(program)
