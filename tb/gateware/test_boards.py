# SPDX-License-Identifier: BSD-2-Clause
"""Every board: it can be built, its constraints are for just the top that is built; pins that a board does without."""

import json
import re
from collections import Counter

import pytest
from amaranth import Module
from amaranth.lib.wiring import Component, In, Out

from soc import ecp5, gateware, pins
from soc.pins_rules import Case, check
from tb import toolchain


def ports(rtlil):
    """``{bit's name in a constraint file: direction}`` of the module ``top`` of an RTLIL text."""
    top = re.search(r"^module \\top$.*?^end$", rtlil, re.MULTILINE | re.DOTALL)[0]
    return {name if width == "1" else f"{name}[{bit}]": {"input": "in", "output": "out"}[direction]
            for width, direction, name in re.findall(r"^  wire width (\d+) (input|output) \d+ +\\(\w+)$", top, re.MULTILINE)
            for bit in range(int(width))}


@pytest.mark.parametrize("name", sorted(gateware.boards()))
def test_the_pins_of_the_top_that_is_built_are_those_of_the_constraints(name):
    board = gateware.board(name)
    path = toolchain.ROOT / "constraints" / f"{name}.lpf"
    text = path.read_text()
    located = {name: direction for name, direction in re.findall(
        r'^LOCATE COMP "([^"]+)" SITE "\w+"; *# [^|]*\| (in|out) \|', text, re.MULTILINE)}
    built = ports(toolchain.to_rtlil(board(), name="top"))
    assert built == located and len(built) > 60
    assert text.count(f'FREQUENCY PORT "{board.oscillator[0]}" {board.oscillator[1] / 1e6:g} MHZ;') == 1

    board_file, = (f for f in pins.boards() if f.path == path.resolve())
    assert board in board_file.boards
    assert check(Case(pins.parse(text), ports={name: pins.ports(board)},
                      balls={board.device: pins.package(board.device, board.package)}, facts=board_file.facts)) == []


@pytest.mark.parametrize("name", sorted(gateware.boards()))
def test_a_reset_waits_as_long_with_every_oscillator(name):
    """At least the times that docs/gateware.md states, and at most a clock longer."""
    hz = gateware.board(name).oscillator[1]
    clocks = ecp5.ClockGenerator(input_hz=hz, sync_hz=50_000_000, fast_hz=200_000_000)
    assert [float(f) for f in clocks.settings.outputs_hz] == [200e6, 50e6]
    for waits, seconds in (clocks.hold_clocks, 10.24e-6), (clocks.quiet_clocks, 0.64e-6):
        assert seconds * hz - 1e-6 <= waits < seconds * hz + 1


class Echo(Component):
    """Stands in for the controller: shows what its inputs read."""

    def __init__(self, *, build_id, regions):
        super().__init__({**{name: In(1) for name in ecp5.INTERNAL - {"cpu_asleep"}}, "estop": In(1), "limit_lower": In(4),
                          "dip": In(4), "pwm": Out(4), "shown_dip": Out(4), "shown_estop": Out(1), "shown_limit": Out(4)})

    def elaborate(self, platform):
        m = Module()
        m.d.comb += [self.shown_dip.eq(self.dip), self.shown_estop.eq(self.estop), self.shown_limit.eq(self.limit_lower),
                     self.pwm.eq(self.dip)]
        return m


@pytest.fixture
def small(monkeypatch):
    """Makes the class of a board around an :class:`Echo`, without the pins of ``absent``."""
    monkeypatch.setattr(ecp5, "Abbe", Echo)

    def make(**absent):
        class Small(ecp5.Board):
            name, oscillator, ABSENT = "small", ("clk12", 12_500_000), absent
        return Small
    return make


def test_absent_inputs_read_their_level_and_absent_outputs_are_no_pins(small, tmp_path):
    board = small(dip=0b0101, estop=1, limit_lower=0b1111, pwm=None)()
    (tmp_path / "top.il").write_text(toolchain.to_rtlil(board, name="top"))
    toolchain.yosys("read_rtlil top.il; hierarchy -top top; proc; flatten; opt; write_json top.json", cwd=tmp_path)
    ports = json.loads((tmp_path / "top.json").read_text())["modules"]["top"]["ports"]
    assert {name: port["bits"] for name, port in ports.items() if name != "clk12"} == {
        "shown_dip": ["1", "0", "1", "0"], "shown_estop": ["1"], "shown_limit": ["1"] * 4}
    assert Counter(port["direction"] for port in ports.values()) == {"output": 3, "input": 1}


@pytest.mark.parametrize("absent, said", [
    ({"estop": 0}, "small: estop in ABSENT must be 1, as with a broken wire, not 0"),
    ({"limit_lower": 0b1110}, "limit_lower in ABSENT must be 15, as with a broken wire"),
    ({"dip": 16}, "dip in ABSENT must be an integer from 0 to 15, not 16"),
    ({"dip": None}, "dip in ABSENT must be an integer"),
    ({"pwm": 0}, "pwm in ABSENT must be None, as it is an output"),
    ({"fast_clk": 0}, "'fast_clk' in ABSENT is no pin of the controller"),
    ({"dipp": 0}, "'dipp' in ABSENT is no pin"),
])
def test_what_cannot_be_absent_is_refused(small, absent, said):
    with pytest.raises(ValueError, match=said):
        small(**absent)()
