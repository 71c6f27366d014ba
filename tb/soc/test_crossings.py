# SPDX-License-Identifier: BSD-2-Clause
"""Every way from one clock domain to another, in the netlist of the controller and of a board, is one of rtl/crossing.py's.

Looks at single bits of the netlist, so nothing depends on what the source says.  A flip-flop may depend on

* flip-flops of its own domain, and its reset;
* a flip-flop ``cross_hold`` of another domain (it has an enable; that it is still while it is read is proven in
  ``tb/formal/crossing.py``);
* a ``cross_toggle`` of another domain or an input pin, if it is the first stage of a synchroniser and nothing
  lies between but an inverter at a pin; that stage feeds the second one only, and a ``cross_toggle`` one synchroniser only.

On a board there is the domain of its oscillator too.  Its ``reset`` may reach all flip-flops, as it changes only while
the others have no clock edges (``tb/gateware/test_reset.py``); what the PLL says counts as a pin.

Output pins are flip-flops.  ``cpu`` is ``sync`` (its clock is left out now and then, see :mod:`soc.cpu`); the
processor and the memory arrays have one clock each, so they are boxes here whose every pin is a flip-flop.
"""

import json
import re
from collections import defaultdict
from functools import cache

import pytest
from amaranth import ClockDomain, ClockSignal, Module, Signal
from amaranth.lib import cdc, wiring
from amaranth.lib.wiring import In, Out

from rtl import crossing
from rtl.quadrature import DecoderSettings
from rtl.trigger import TriggerPeripheral
from soc import cpu, gateware, memory, pins
from soc.top import Abbe
from tb import toolchain

CLOCKS = {"clk": "sync", "cpu_clk": "sync", "fast_clk": "fast"}
RESETS = {"rst": "sync", "cpu_rst": "sync", "fast_rst": "fast"}
BOXES = {"VexRiscv", "abbe_memory"}
BOARD_CLOCKS = {"clocks.sync_clk": "sync", "clocks.fast_clk": "fast"}
BOARD_RESET = "clocks.sequencer.reset"
COMBINATIONAL_PINS = {"cpu_asleep"}             # for a simulator, not a pin of a board
SCRIPT = ("read_rtlil top.il; read_verilog -lib +/ecp5/cells_bb.v; read_verilog -lib cpu.v; read_verilog -lib -sv memory.v; hierarchy -top top; "
          "proc; flatten; opt_clean; memory_map; opt_dff; simplemap; opt_clean; write_json top.json")


class Netlist:
    """Bits and what drives them: ``pins`` {input bit: pin's name}, ``outputs`` {(pin, n): bit}, ``flops`` {output
    bit: (domain, other input bits, bits at D, has an enable)}, ``drivers`` {output bit of logic: input bits}.

    ``oscillator``: of a board, its pin.
    """

    def __init__(self, module, oscillator=None):
        self.pins, self.outputs, self.drivers, self.flops = {}, {}, {}, {}
        self.paths = defaultdict(set)
        names = CLOCKS if oscillator is None else {**BOARD_CLOCKS, oscillator: "board"}
        clock_bits = {module["netnames"][name]["bits"][0]: domain for name, domain in names.items()
                      if name in module["netnames"]}
        for name, port in module["ports"].items():
            if port["direction"] == "input":
                self.pins |= dict.fromkeys(port["bits"], name)
            else:
                self.outputs |= {(name, n): bit for n, bit in enumerate(port["bits"])}
        for name, net in module["netnames"].items():
            for bit in net["bits"]:
                self.paths[bit].add(name)
        for cell in module["cells"].values():
            self._add(cell, clock_bits)

    def _add(self, cell, clock_bits):
        inputs, outputs = set(), set()
        for port, bits in cell["connections"].items():
            group = outputs if cell["port_directions"][port] == "output" else inputs
            group |= {bit for bit in bits if isinstance(bit, int)}
        if cell["type"] == "EHXPLLL":
            self.pins |= dict.fromkeys(outputs, "of the PLL")
            return
        clocked = re.match(r"\$_\w*DFF|\$.*dff", cell["type"]) or cell["type"] in BOXES
        if not clocked:
            assert not re.match(r"\$(_DLATCH|dlatch|mem|_SR)", cell["type"]), f"unknown storage {cell['type']}"
            self.drivers |= dict.fromkeys(outputs, inputs)
            return
        clocks = inputs & clock_bits.keys()
        assert len(clocks) == 1, f"{cell['type']} has {len(clocks)} clocks"
        flop = (clock_bits[clocks.pop()], inputs - clock_bits.keys(), cell["connections"].get("D", []),
                "E" in cell["connections"])
        self.flops |= dict.fromkeys(outputs, flop)

    @cache
    def sources(self, bit):
        """Flip-flops and pins on which the value of a bit depends, through logic only."""
        found, seen, stack = set(), set(), [bit]
        while stack:
            here = stack.pop()
            if here in seen:
                continue
            seen.add(here)
            if here in self.flops or here in self.pins:
                found.add(here)
            else:
                stack += self.drivers.get(here, ())
        return frozenset(found)

    def called(self, bit, name):
        """Whether the signal has this name in the source, in whatever submodule."""
        return any(re.fullmatch(rf"(.*\.)?{name}(\$\d+)?", path) for path in self.paths[bit])

    def path(self, bit):
        return min(self.paths[bit], default=f"bit {bit}")


def violations(netlist):
    """Sentences, one for each bit that comes from another domain in a way that is no pattern."""
    wrong, synchronisers, crossings = [], defaultdict(set), 0
    for bit, flop in netlist.flops.items():
        domain, inputs, data, enabled = flop
        first = netlist.called(bit, "stage0")
        if netlist.called(bit, "cross_hold") and not enabled:
            wrong.append(f"{netlist.path(bit)} is never still")
        for source in frozenset().union(*map(netlist.sources, inputs)):
            if source in netlist.pins:
                pin = netlist.pins[source]
                alone = data == [source] or netlist.drivers.get(data[0] if data else None) == {source}      # inverted
                foreign, known = RESETS.get(pin) != domain, first and alone and pin not in RESETS
                what = f"pin {pin}"
            else:
                foreign = netlist.flops[source][0] != domain
                toggle = netlist.called(source, "cross_toggle") and first and data == [source]
                known = toggle or netlist.called(source, "cross_hold") or BOARD_RESET in netlist.paths[source]
                what = f"{netlist.path(source)} of {netlist.flops[source][0]}"
                if foreign and toggle:
                    synchronisers[source].add(bit)
                if netlist.called(source, "stage0") and not (netlist.called(bit, "stage1") and data == [source]):
                    wrong.append(f"{netlist.path(bit)} reads {what} before its second stage")
            if foreign:
                crossings += 1
            if foreign and not known:
                wrong.append(f"{netlist.path(bit)} of {domain} depends on {what}")
    wrong += [f"{netlist.path(source)} is read by {len(bits)} synchronisers"
              for source, bits in synchronisers.items() if len(bits) > 1]
    return wrong, crossings


def netlist_of(component, directory, oscillator=None):
    (directory / "top.il").write_text(toolchain.to_rtlil(component, name="top"))
    (directory / "cpu.v").write_text(cpu.netlist())
    (directory / "memory.v").write_text(memory.VERILOG.read_text())
    toolchain.yosys(SCRIPT, cwd=directory)
    return Netlist(json.loads((directory / "top.json").read_text())["modules"]["top"], oscillator)


@pytest.fixture(scope="module", autouse=True)
def short_queue():
    """The trigger's queue with room for four records: in flip-flops, 1024 would take minutes to walk."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(TriggerPeripheral.__init__.__kwdefaults__, "depth", 4)
        yield


@pytest.fixture(scope="module")
def controller(tmp_path_factory):
    return netlist_of(Abbe(), tmp_path_factory.mktemp("controller"))


def test_every_crossing_of_the_controller_is_of_a_known_pattern(controller):
    wrong, crossings = violations(controller)
    print(f"{len(controller.flops)} flip-flop bits, {crossings} dependences on another domain or a pin")
    assert not wrong, f"{len(wrong)}: " + "; ".join(sorted(wrong)[:10])
    assert crossings > 500              # the walk has seen them: hold registers alone are more bits than that


def test_every_output_pin_is_a_flip_flop(controller):
    assert [pin for pin, bit in controller.outputs.items()
            if pin[0] not in COMBINATIONAL_PINS and bit not in controller.flops] == []


def test_a_crossing_broken_in_the_controller_is_found(monkeypatch, tmp_path):
    """The settings of the encoders taken live, not from the register that holds them still."""
    elaborate = crossing.Hold.elaborate

    def live(self, platform):
        if self._shape is not DecoderSettings:
            return elaborate(self, platform)
        m = Module()
        m.d.comb += self.o.eq(self.i)
        return m

    monkeypatch.setattr(crossing.Hold, "elaborate", live)
    wrong, _ = violations(netlist_of(Abbe(), tmp_path))
    assert len(wrong) == 4 * 5 and all(re.search(r"quadrature\d.* of fast depends on .* of sync", w) for w in wrong)


@pytest.mark.parametrize("board", [file.boards[0] for file in pins.boards()], ids=lambda board: board.name)
def test_every_crossing_of_a_board_is_of_a_known_pattern(board, tmp_path):
    netlist = netlist_of(board(), tmp_path, board.oscillator[0])
    assert {flop[0] for flop in netlist.flops.values()} == {"board", "sync", "fast"}
    wrong, _ = violations(netlist)
    assert not wrong, f"{len(wrong)}: " + "; ".join(sorted(wrong)[:10])


def test_a_crossing_broken_on_a_board_is_found(tmp_path):
    """Reset asked for by the flip-flop of motor enable, and by the button, without a synchroniser."""
    board = gateware.board("ulx3s-85f")

    class Broken(board):
        def system(self, m, clocks):
            seen, asked = Signal(), Signal()
            m.domains.own = ClockDomain("own", reset_less=True)
            m.d.comb += [ClockSignal("own").eq(self.clk25), clocks.request.eq(seen | asked), self.led.eq(seen)]
            m.d.own += [seen.eq(self.motor_enable), asked.eq(~self.reset_button_n)]

    wrong, _ = violations(netlist_of(Broken(), tmp_path, "clk25"))
    assert any(re.search("of board depends on .* of sync", w) for w in wrong), wrong
    assert any("of board depends on pin reset_button_n" in w for w in wrong), wrong


class Sample(wiring.Component):
    """A pin and flip-flops of ``sync``, brought into ``fast`` in the way that is tried."""

    pin: In(1)
    o: Out(1)

    def __init__(self, way):
        self._way = way
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        level, toggle, hold, seen = Signal(), Signal(name="cross_toggle"), Signal(name="cross_hold"), Signal()
        m.submodules.pin_sync = cdc.FFSynchronizer(self.pin, level)
        m.d.sync += [toggle.eq(toggle ^ level)]
        with m.If(toggle):
            m.d.sync += hold.eq(level)
        m.d.fast += self.o.eq(seen)
        self._way(m, self.pin, level, toggle, hold, seen)
        return m


def synchronised(m, i, o, name="sync"):
    m.submodules[f"fast_{name}"] = cdc.FFSynchronizer(i, o, o_domain="fast")


def twice(m, i, o):
    a, b = Signal(), Signal()
    synchronised(m, i, a, "a")
    synchronised(m, i, b, "b")
    m.d.comb += o.eq(a & b)


def follow(m, i, o):
    hold = Signal(name="cross_hold")
    m.d.sync += hold.eq(i)
    m.d.comb += o.eq(hold)


def one_stage(m, i, o):
    first, second = Signal(name="stage0"), Signal(name="stage1")
    m.d.fast += [first.eq(i), second.eq(first)]
    m.d.comb += o.eq(first ^ second)


WAYS = {
    "toggle": (None, lambda m, pin, level, toggle, hold, o: synchronised(m, toggle, o)),
    "hold": (None, lambda m, pin, level, toggle, hold, o: m.d.comb.__iadd__(o.eq(hold))),
    "pin": (None, lambda m, pin, level, toggle, hold, o: synchronised(m, pin, o)),
    "nothing": ("depends on", lambda m, pin, level, toggle, hold, o: m.d.comb.__iadd__(o.eq(level))),
    "raw toggle": ("depends on", lambda m, pin, level, toggle, hold, o: m.d.comb.__iadd__(o.eq(toggle))),
    "raw pin": ("depends on pin", lambda m, pin, level, toggle, hold, o: m.d.comb.__iadd__(o.eq(pin))),
    "a level that is no toggle": ("depends on", lambda m, pin, level, toggle, hold, o: synchronised(m, level, o)),
    "logic before it": ("depends on", lambda m, pin, level, toggle, hold, o: synchronised(m, toggle ^ hold, o)),
    "a pin inverted": (None, lambda m, pin, level, toggle, hold, o: synchronised(m, ~pin, o)),
    "a pin and logic": ("depends on pin", lambda m, pin, level, toggle, hold, o: synchronised(m, pin ^ hold, o)),
    "two synchronisers": ("read by 2", lambda m, pin, level, toggle, hold, o: twice(m, toggle, o)),
    "a hold that follows": ("never still", lambda m, pin, level, toggle, hold, o: follow(m, level, o)),
    "one stage": ("before its second stage", lambda m, pin, level, toggle, hold, o: one_stage(m, toggle, o)),
}


@pytest.mark.parametrize("way", WAYS)
def test_only_the_known_patterns_pass(way, tmp_path):
    complaint, build = WAYS[way]
    wrong, crossings = violations(netlist_of(Sample(build), tmp_path))
    assert crossings
    assert any(complaint in w for w in wrong) if complaint else not wrong, wrong
