# SPDX-License-Identifier: BSD-2-Clause
"""The netlist of the product for the FPGA: its size, and what holds its motor pins when the clocks cannot be trusted."""

import fnmatch
import json
import os
import re
from collections import Counter

import pytest

from soc import gateware
from soc.ecp5 import MOVES
from soc.top import PERIPHERALS

LUTS = {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 6}
"""Places of LUTs that a cell takes (nextpnr counts so too)."""

LUTS_25F = 24288
SPINE = {"identity", "bus", "inputs", "serial", "timer", "snapshot", "pwm", "line",
         *(f"quadrature{n}" for n in range(4))}
"""Parts with registers that make the spine; the processor, its memory and its bus belong to it, other parts do not."""


FAST_MODULES = {*(f"controller.quadrature{n}.decoder" for n in range(4)), "controller.line.line",
                "controller.snapshot.timestamp", "controller.trigger.capture", "controller.classifier.input",
                "controller.classifier.queue.gather", "controller.led.pwm"}


@pytest.fixture(scope="module")
def directory():
    """Where the product is synthesised; done once for everybody who asks for this content."""
    return gateware.Flow(gateware.board("ulx3s-85f")).netlist()


@pytest.fixture(scope="module")
def netlist(directory):
    """The module ``top`` as yosys writes it."""
    return json.loads((directory / "top.json").read_text())["modules"]["top"]


def test_the_modules_of_fast_are_mapped_apart(directory):
    modules = re.findall(r"^module \\top\.(\S+)$", (directory / "top.il").read_text(), re.MULTILINE)
    assert {m for m in modules for pattern in gateware.FAST_MODULES.split()
            if fnmatch.fnmatchcase(f"top.{m}", pattern)} == FAST_MODULES


def test_wide_multiplexers_are_in_the_modules_of_fast_alone(netlist):
    wide = [name for name, cell in netlist["cells"].items() if cell["type"] in ("PFUMX", "L6MUX21")]
    assert {next((f for f in FAST_MODULES if name.startswith(f"{f}.")), name) for name in wide} == FAST_MODULES


def test_the_spine_takes_at_most_35_percent_of_a_25f(netlist):
    luts = Counter()
    for name, cell in netlist["cells"].items():
        path = re.sub(r"\$\d+", "", name).split(".")
        luts[path[1] if path[0] == "controller" and len(path) > 2 else "glue"] += LUTS.get(cell["type"], 0)
    later = {p.part or p.name for p in PERIPHERALS} - SPINE
    assert later <= set(luts) and SPINE - {"identity"} <= set(luts)         # the names are still those of the parts
    whole, spine = luts.total(), sum(n for part, n in luts.items() if part not in later)
    print(f"{whole} LUTs, {100 * whole / LUTS_25F:.1f} % of a 25F; spine {spine}, {100 * spine / LUTS_25F:.1f} %")
    assert 0.2 * LUTS_25F < spine <= 0.35 * LUTS_25F


def test_the_memories_are_block_ram(netlist):
    kinds = Counter(name.split(".words.")[0] for name, cell in netlist["cells"].items() if cell["type"] == "DP16KD")
    for region in gateware.board("ulx3s-85f").regions():
        assert kinds[f"controller.memory.{region.name}"] == region.size // 2048       # bytes in 16 kbit


def test_motor_pins_are_low_while_the_reset_sequencer_says_so(netlist):
    """Their last LUT gives 0 whatever else it sees, as soon as ``safe``, a flip-flop of the oscillator, is 1."""
    drivers = {bit: cell for cell in netlist["cells"].values() for port, bits in cell["connections"].items()
               if cell["port_directions"][port] == "output" for bit in bits}
    safe = netlist["netnames"]["clocks.sequencer.safe"]["bits"][0]
    clock = netlist["ports"]["clk25"]["bits"][0]
    assert drivers[safe]["type"] == "TRELLIS_FF" and drivers[safe]["connections"]["CLK"] == [clock]
    pins = [(name, bit) for name in MOVES for bit in netlist["ports"][name]["bits"]]
    assert len(pins) == 5
    for name, bit in pins:
        lut = drivers[bit]
        assert lut["type"] == "LUT4", name
        table = int(lut["parameters"]["INIT"], 2)
        inputs = [lut["connections"][port] for port in "ABCD"]
        place = inputs.index([safe])
        assert all(not table >> n & 1 for n in range(16) if n >> place & 1), name
        # The other input is the flip-flop that drives the pin when all is well.
        others = [drivers[i[0]]["type"] for i in inputs if i != [safe] and isinstance(i[0], int)]
        assert others == ["TRELLIS_FF"], name


@pytest.mark.skipif("FULL_BUILD" not in os.environ, reason="places and routes twice; make test-slow")
def test_two_builds_from_nothing_give_the_same_bitstream(tmp_path):
    bitstreams = []
    for name in "first", "second":
        flow = gateware.Flow(gateware.board("ulx3s-85f"), directory=tmp_path / name)
        words, _, whole = gateware.firmware_words(flow.board.regions())
        assert whole
        bitstreams.append(flow.pack(1, words).read_bytes())
    assert bitstreams[0] == bitstreams[1] and len(bitstreams[0]) > 100_000
