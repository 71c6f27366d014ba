# SPDX-License-Identifier: BSD-2-Clause
"""A Verilog ``dut`` under Verilator, driven by the cocotb tests of one file."""

import contextlib
import inspect
import os
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from tb import toolchain

__all__ = ["build", "failures"]

TIMESCALE = ("1ps", "1ps")


def _ports(source):
    """Names of the ports of ``dut`` in a file, one declaration per line as yosys writes them."""
    module = re.search(r"^module dut\b.*?^endmodule", source.read_text(), re.MULTILINE | re.DOTALL)[0]
    return re.findall(r"^ *(?:input|output) (?:.* )?\\?(\w+) ?[;,]?$", module, re.MULTILINE)


def build(name, write_sources, *, arguments=("--no-timing",)):
    """The directory ``build/cocotb/<name>`` with a simulation of the module ``dut``, made once.

    ``name`` names the content: same name, same simulation.  ``write_sources(directory)`` writes Verilog there
    and returns the list of all files to compile, the one with ``dut`` last.  Several processes may ask for the
    same name at once.  Tests see the ports of ``dut`` and nothing else: with everything visible, as cocotb has
    it, Verilator can leave nothing out, and compiles a netlist five times as long.
    """
    from cocotb_tools.runner import get_runner
    directory = toolchain.BUILD / "cocotb" / name
    with toolchain.cached(directory) as empty:
        if empty:
            sources = write_sources(directory)
            control = directory / "control.vlt"
            control.write_text("`verilator_config\nlint_off\n" + "".join(
                f'public_flat_rw -module "dut" -var "{port}"\n' for port in _ports(sources[-1])))
            get_runner("verilator").build(
                sources=[control, *sources], hdl_toplevel="dut", build_dir=directory, always=True,
                timescale=TIMESCALE, build_args=["-Wno-fatal", "--no-public-flat-rw", *arguments],
                log_file=directory / "build.log")
    return directory


def failures(directory, module, *, label, tests=None, env=None, plusargs=()):
    """Run the ``@cocotb.test`` coroutines of a Python ``module``; return the names of those that failed.

    ``label`` tells this run's results from others in the same directory.  ``tests``: regular expression, only
    those whose name it finds.  ``env`` reaches the coroutines through ``os.environ``.  Random numbers are the
    same at every run, others with ``SEED`` set in the environment; each test prints its own.  Raises
    :exc:`AssertionError` if no coroutine ran.
    """
    from cocotb_tools.runner import get_runner
    source = Path(inspect.getfile(module))
    sys.path.insert(0, str(source.parent))
    results = directory / f"{label}-{os.getpid()}.xml".replace("/", "-")
    results.unlink(missing_ok=True)
    with contextlib.suppress(SystemExit):           # so says cocotb, under pytest, that some failed
        get_runner("verilator").test(
            hdl_toplevel="dut", test_module=source.stem, build_dir=directory, test_dir=directory,
            seed=os.environ.get("SEED", "1"), hdl_toplevel_lang="verilog", results_xml=str(results),
            timescale=TIMESCALE, extra_env={"COCOTB_RESOLVE_X": "ZEROS", **(env or {})}, test_filter=tests,
            plusargs=plusargs)
    cases = list(ElementTree.parse(results).iter("testcase"))
    assert cases, "no cocotb test ran"
    return [c.get("name") for c in cases if c.find("failure") is not None or c.find("error") is not None]
