# SPDX-License-Identifier: BSD-2-Clause
"""Memories and multipliers as source and as netlist side by side: the design under test of ``test_models.py``.

Every shape is written once, as Verilog that yosys recognises, and compiled twice: as it is, and as the netlist
of it.  Both get the same inputs; bit n of ``wrong`` says that the outputs of shape n differ where they are
defined.
"""

import re
from dataclasses import dataclass

from soc.memory import VERILOG
from tb.gates import netlist

__all__ = ["SHAPES", "Shape", "build"]

TWO_PORTS = """
module NAME (input clk, input a_enable, b_enable, input [3:0] a_write, b_write, input [13:0] a_address, b_address,
             input [35:0] a_data, b_data, output reg [WIDTH-1:0] a_q, b_q);
  (* no_rw_check *) reg [WIDTH-1:0] words [0:2**BITS-1];
  initial $readmemh("SHAPE.hex", words);
  integer i, j;
  always @(posedge clk) if (a_enable) begin
    if (a_write == 0) a_q <= words[a_address[BITS-1:0]];
    for (i = 0; i < LANES; i = i + 1)
      if (a_write[i]) words[a_address[BITS-1:0]][i*LANE +: LANE] <= a_data[i*LANE +: LANE];
  end
  always @(posedge clk) if (b_enable) begin
    if (b_write == 0) b_q <= words[b_address[BITS-1:0]];
    for (j = 0; j < LANES; j = j + 1)
      if (b_write[j]) words[b_address[BITS-1:0]][j*LANE +: LANE] <= b_data[j*LANE +: LANE];
  end
endmodule
"""
"""Each port reads or writes; while it writes its output stays."""

ONE_PORT = """
module NAME (input clk, input a_enable, b_enable, input [3:0] a_write, b_write, input [13:0] a_address, b_address,
             input [35:0] a_data, b_data, output reg [WIDTH-1:0] a_q, b_q);
  reg [WIDTH-1:0] words [0:2**BITS-1];
  initial $readmemh("SHAPE.hex", words);
  integer i;
  always @(posedge clk) if (a_enable) begin
    a_q <= words[a_address[BITS-1:0]];
    for (i = 0; i < LANES; i = i + 1)
      if (a_write[i]) words[a_address[BITS-1:0]][i*LANE +: LANE] <= a_data[i*LANE +: LANE];
  end
  always @(*) b_q = 0;
endmodule
"""
"""One port; while it writes it shows what was there before."""

READ_AND_WRITE = """
module NAME (input clk, input a_enable, b_enable, input [3:0] a_write, b_write, input [13:0] a_address, b_address,
             input [35:0] a_data, b_data, output reg [WIDTH-1:0] a_q, b_q);
  (* no_rw_check *) reg [WIDTH-1:0] words [0:2**BITS-1];
  initial $readmemh("SHAPE.hex", words);
  integer i;
  always @(posedge clk) begin
    for (i = 0; i < LANES; i = i + 1)
      if (a_enable & a_write[i]) words[a_address[BITS-1:0]][i*LANE +: LANE] <= a_data[i*LANE +: LANE];
    if (b_enable) b_q <= words[b_address[BITS-1:0]];
  end
  always @(*) a_q = 0;
endmodule
"""
"""Port a writes, port b reads."""

CONTROLLER = """
module NAME (input clk, input a_enable, b_enable, input [3:0] a_write, b_write, input [13:0] a_address, b_address,
             input [35:0] a_data, b_data, output [WIDTH-1:0] a_q, b_q);
  abbe_memory #(.WORDS(2**BITS), .ADDRESS_WIDTH(BITS), .CONTENTS("SHAPE.hex")) words (
    .clk(clk), .a_enable(a_enable), .a_address(a_address[BITS-1:0]), .a_data(a_q),
    .b_enable(b_enable), .b_address(b_address[BITS-1:0]), .b_data(b_q),
    .b_write(b_write), .b_write_data(b_data[WIDTH-1:0]));
endmodule
"""
"""The memory of the controller, soc/memory.v: port b reads and writes bytes, and shows anything when it writes."""

PRODUCT = """
module NAME (input clk, input a_enable, b_enable, input [3:0] a_write, b_write, input [13:0] a_address, b_address,
             input [35:0] a_data, b_data, output reg [WIDTH-1:0] a_q, b_q);
  wire signed [BITS:0] a = {SIGN_A a_data[BITS-1], a_data[BITS-1:0]};
  wire signed [BITS:0] b = {SIGN_B b_data[BITS-1], b_data[BITS-1:0]};
  wire signed [2*BITS+1:0] p = a * b;
  always @(*) {b_q, a_q} = p[2*BITS-1:0];
endmodule
"""

MAY_CLASH = TWO_PORTS, READ_AND_WRITE, CONTROLLER
"""Memories with two ports, of which one may write what the other reads."""


@dataclass(frozen=True)
class Shape:
    """``template`` with 2**``bits`` words of ``lanes`` times ``lane`` bits; ``cell``: the block it must become."""
    name: str
    template: str
    bits: int
    lane: int
    lanes: int = 1
    cell: str = "DP16KD"

    @property
    def width(self):
        return self.lane * self.lanes

    def source(self, module):
        values = {"NAME": module, "SHAPE": self.name, "BITS": self.bits, "WIDTH": self.width, "LANES": self.lanes,
                  "LANE": self.lane, "SIGN_A": "1'b1 &" if "s" in self.name[-2:-1] else "1'b0 &",
                  "SIGN_B": "1'b1 &" if "s" in self.name[-1:] else "1'b0 &"}
        return re.sub(r"\b(" + "|".join(values) + r")\b", lambda word: str(values[word[0]]), self.template)


SHAPES = (
    *(Shape(f"two_ports_{lane * lanes}", TWO_PORTS, bits, lane, lanes)
      for bits, lane, lanes in ((10, 9, 2), (11, 9, 1), (12, 4, 1), (13, 2, 1), (14, 1, 1))),
    *(Shape(f"one_port_{lane * lanes}", ONE_PORT, bits, lane, lanes)
      for bits, lane, lanes in ((10, 9, 2), (12, 4, 1), (11, 8, 4))),
    Shape("read_and_write_36", READ_AND_WRITE, 9, 9, 4),
    Shape("read_and_write_32", READ_AND_WRITE, 9, 8, 4),
    Shape("controller_32", CONTROLLER, 11, 8, 4),
    *(Shape(f"product_{bits}_{signs}", PRODUCT, bits, bits, cell="MULT18X18D")
      for bits, signs in ((18, "uu"), (18, "ss"), (18, "su"), (32, "uu"), (32, "su"))),
)


INPUTS = {"clk": 1, "a_enable": 1, "b_enable": 1, "a_write": 4, "b_write": 4, "a_address": 14, "b_address": 14,
          "a_data": 36, "b_data": 36}
DECLARED = [f"  input {f'[{bits - 1}:0] ' if bits > 1 else ''}{name}" for name, bits in INPUTS.items()]
CONNECTED = ", ".join(f".{name}({name})" for name in INPUTS)


def _all(kind):
    """The text of the module ``<kind>``, one instance of every shape, with their outputs ``a0``, ``b0``, ``a1``, ..."""
    ports, instances = list(DECLARED), []
    for n, shape in enumerate(SHAPES):
        ports += [f"  output [{shape.width - 1}:0] {port}{n}" for port in "ab"]
        instances.append(f"  {shape.name}_{kind} {shape.name} ({CONNECTED}, .a_q(a{n}), .b_q(b{n}));")
    modules = [shape.source(f"{shape.name}_{kind}") for shape in SHAPES]
    memory = "`define SYNTHESIS\n`define INITIALISED\n" + VERILOG.read_text()
    return "\n".join([memory, *modules, f"module {kind} (", ",\n".join(ports), ");", *instances, "endmodule\n"])


def _side_by_side():
    """The text of ``dut``: source and netlist, and where they disagree."""
    last = len(SHAPES) - 1
    lines = ["module dut (", ",\n".join([*DECLARED, f"  output [{last}:0] wrong", f"  output [{last}:0] clash"]), ");"]
    for kind in "rtl", "gates":
        wires = [f"{port}{n}" for n in range(len(SHAPES)) for port in "ab"]
        lines += [f"  wire [{SHAPES[int(wire[1:])].width - 1}:0] {kind}_{wire};" for wire in wires]
        lines.append(f"  {kind} {kind} ({CONNECTED}, " + ", ".join(f".{wire}({kind}_{wire})" for wire in wires) + ");")
    for n, shape in enumerate(SHAPES):
        lines.append(f"  reg a_clash{n} = 0, b_clash{n} = 0;")
        if shape.template in MAY_CLASH:
            # A port that reads what the other writes has anything at its output, until it reads again.
            same = f"a_address[{shape.bits - 1}:0] == b_address[{shape.bits - 1}:0]"
            a_writes = f"a_enable & |a_write[{shape.lanes - 1}:0]" if shape.template is not CONTROLLER else "0"
            b_writes = f"b_enable & |b_write[{shape.lanes - 1}:0]" if shape.template is not READ_AND_WRITE else "0"
            a_reads = "~|a_write" if shape.template is TWO_PORTS else "1"
            b_reads = "~|b_write" if shape.template is TWO_PORTS else "1"
            own = "b_enable & |b_write" if shape.template is CONTROLLER else "0"
            lines += ["  always @(posedge clk) begin",
                      f"    if (a_enable & {a_reads}) a_clash{n} <= {same} & {b_writes};",
                      f"    if (b_enable & {b_reads}) b_clash{n} <= {own} | ({same} & {a_writes});", "  end"]
        for port in "ab":
            lines.append(f"  wire {port}_differs{n} = rtl_{port}{n} != gates_{port}{n};")
        lines += [f"  assign wrong[{n}] = (a_differs{n} & ~a_clash{n}) | (b_differs{n} & ~b_clash{n});",
                  f"  assign clash[{n}] = (a_differs{n} & a_clash{n}) | (b_differs{n} & b_clash{n});"]
    return "\n".join([*lines, "endmodule\n"])


def _check(text):
    """Fail if a memory or a product has not become the block that is to be tested."""
    products = [shape for shape in SHAPES if shape.cell == "MULT18X18D"]
    assert len(re.findall(r"^  MULT18X18D ", text, re.MULTILINE)) >= len(products)
    for shape in SHAPES:
        assert shape in products or re.search(rf"^  \) \\{shape.name}\.(words\.)+0\.0 ", text, re.MULTILINE), shape.name


def build(random):
    """The simulation; initial contents come from ``random``.  Fails if a shape did not become its block."""
    files = {f"{shape.name}.hex": "".join(f"{random.getrandbits(shape.width):x}\n" for _ in range(2**shape.bits))
             for shape in SHAPES if shape.cell == "DP16KD"}
    files["boot.hex"] = "0\n"            # the default of soc/memory.v, which yosys reads before it knows better
    files |= {"rtl.v": _all("rtl"), "gates.v": _all("gates"), "dut.v": _side_by_side()}

    def write_sources(directory):
        for name, text in files.items():
            (directory / name).write_text(text)
        path = netlist.synthesise(directory, "read_verilog -sv gates.v", top="gates")
        _check(path.read_text())
        return [directory / "rtl.v", path, directory / "dut.v"]

    return netlist.simulation(netlist.content_key(*files.values()), write_sources)
