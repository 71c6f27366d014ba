# SPDX-License-Identifier: BSD-2-Clause
"""The ``simulate`` fixture: an Amaranth component under Verilator, driven by the cocotb tests of the same file."""

import fcntl
import inspect
import os
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from tb import toolchain
from tb.metastability import RandomDelayPlatform

toolchain.activate()


@pytest.fixture
def simulate(request):
    """``simulate(component, ports=None, random_delay=False, tests=None, env={})``.

    Emits Verilog (top ``dut``), builds it with Verilator once per content under ``build/cocotb``, and runs the
    ``@cocotb.test`` coroutines of the calling file, or those whose name matches the regular expression
    ``tests``.  ``env`` reaches the coroutines through ``os.environ``.  ``random_delay`` gives every
    synchroniser a random extra clock.  Random numbers are the same at every run, others with ``SEED`` set in
    the environment; each test prints its own.  Fails if any coroutine fails or none ran.
    """
    def run(component, *, ports=None, random_delay=False, tests=None, env=None):
        from cocotb_tools.runner import get_runner
        platform = RandomDelayPlatform() if random_delay else None
        rtlil = toolchain.to_rtlil(component, ports=ports, platform=platform)
        build = toolchain.BUILD / "cocotb" / toolchain.content_key(rtlil)
        build.mkdir(parents=True, exist_ok=True)
        runner = get_runner("verilator")
        with open(build / "lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (build / "done").exists():
                toolchain.to_verilog(rtlil, build / "dut.v")
                (build / "timescale.vlt").write_text("`verilator_config\nlint_off\n")
                runner.build(sources=[build / "timescale.vlt", build / "dut.v"], hdl_toplevel="dut",
                             build_dir=build, timescale=("1ps", "1ps"), always=True,
                             build_args=["-Wno-fatal", "--no-timing"], log_file=build / "build.log")
                (build / "done").touch()
        module = Path(inspect.getfile(request.module))
        sys.path.insert(0, str(module.parent))
        results = build / f"{request.node.name}-{os.getpid()}.xml".replace("/", "-")
        runner.test(hdl_toplevel="dut", test_module=module.stem, build_dir=build, test_dir=build, seed=os.environ.get("SEED", "1"),
                    hdl_toplevel_lang="verilog", results_xml=str(results), timescale=("1ps", "1ps"),
                    extra_env={"COCOTB_RESOLVE_X": "ZEROS", **(env or {})}, test_filter=tests)
        cases = list(ElementTree.parse(results).iter("testcase"))
        failed = [c.get("name") for c in cases if c.find("failure") is not None or c.find("error") is not None]
        assert cases, "no cocotb test ran"
        assert not failed, f"failed: {', '.join(failed)}"
    return run
