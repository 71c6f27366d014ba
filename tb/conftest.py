# SPDX-License-Identifier: BSD-2-Clause
"""The ``simulate`` fixture: an Amaranth component under Verilator, driven by the cocotb tests of the same file."""

import os
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tb import toolchain, verilated
from tb.gates import levels, netlist
from tb.metastability import RandomDelayPlatform

toolchain.activate()


def pytest_addoption(parser):
    parser.addoption("--gates", choices=["some", "all"], default="some",
                     help="tests to run on the ECP5 netlist as well: those of the ordinary suite, or all")


def pytest_configure(config):
    config.addinivalue_line("markers", "gates: on the netlist that yosys makes for the ECP5")
    config.addinivalue_line("markers", "slow: in make test-slow (FULL_LINES=1), not in the ordinary suite")


def pytest_collection_modifyitems(config, items):
    """Without ``--gates all``, of the tests on the netlist keep those of :mod:`tb.gates.levels`; slow ones if asked for."""
    def deselect(left):
        config.hook.pytest_deselected(items=left)
        items[:] = [item for item in items if item not in left]

    if "FULL_LINES" not in os.environ:
        deselect([item for item in items if item.get_closest_marker("slow")])
    if config.getoption("gates") == "some":
        deselect([item for item in items if "simulate" in getattr(item, "fixturenames", ())
                  and item.get_closest_marker("gates") and item.nodeid not in levels.ORDINARY])


@pytest.fixture(params=["rtl", pytest.param("gates", marks=pytest.mark.gates)])
def simulate(request):
    """``simulate(component, ports=None, random_delay=False, tests=None, env={})``.

    Emits RTLIL (top ``dut``), builds it with Verilator once per content under ``build/cocotb``, and runs the
    ``@cocotb.test`` coroutines of the calling file, or those whose name matches the regular expression
    ``tests``, as :func:`tb.verilated.failures` says.  ``random_delay`` gives every synchroniser a random extra
    clock.  Fails if any coroutine fails or none ran.

    A test that uses it is two: ``[rtl]`` simulates the source, ``[gates]`` the netlist for the ECP5.
    """
    def run(component, *, ports=None, random_delay=False, tests=None, env=None):
        platform = RandomDelayPlatform() if random_delay else None
        rtlil = toolchain.to_rtlil(component, ports=ports, platform=platform)
        directory = netlist.build(rtlil) if request.param == "gates" else verilated.build(
            toolchain.content_key(rtlil, Path(verilated.__file__)),
            lambda directory: [toolchain.to_verilog(rtlil, directory / "dut.v")])
        failed = verilated.failures(directory, request.module, label=request.node.name, tests=tests, env=env)
        assert not failed, f"failed: {', '.join(failed)}"
    return run
