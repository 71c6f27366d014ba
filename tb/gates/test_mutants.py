# SPDX-License-Identifier: BSD-2-Clause
"""The tests of the scan line notice a netlist that is wrong in one LUT."""

import random
import sys

import pytest

from rtl.line import ScanLine
from tb import toolchain, verilated
from tb.gates import netlist

pytestmark = pytest.mark.gates

TESTS = "plays_the_scenario|any_line"


@pytest.fixture(scope="module")
def failures():
    """``failures(*plusargs)``: what fails of tb/rtl/test_scan_line.py on the netlist; ``failures.mutants``: all."""
    sys.path.insert(0, str(toolchain.ROOT / "tb" / "rtl"))
    import test_scan_line
    directory = netlist.build(toolchain.to_rtlil(ScanLine()), mutable=True)

    def run(*plusargs):
        return verilated.failures(directory, test_scan_line, label="mutant", tests=TESTS, plusargs=plusargs)
    run.mutants = netlist.mutants(directory)
    return run


def test_the_tests_notice_a_wrong_lut(failures, request):
    """The output of a LUT inverted.  Not all have to be noticed: some serve upper bits of counts far away."""
    sample = 40 if request.config.getoption("gates") == "all" else 4
    assert not failures()
    chosen = random.Random(1).sample(sorted({number for number, _ in failures.mutants}), sample)
    noticed = [number for number in chosen if failures(f"+mutant={number}", "+entries=ffff")]
    print(f"{len(noticed)} of {sample} LUTs inverted were noticed")
    assert len(noticed) >= 0.75 * sample


def test_the_tests_notice_a_wrong_entry(failures, request):
    """A single entry of a LUT; many a one is never asked for, as no line brings its inputs about."""
    if request.config.getoption("gates") != "all":
        pytest.skip("make test-gates")
    noticed = sum(bool(failures(f"+mutant={number}", f"+entries={1 << entry:x}"))
                  for number, entry in random.Random(1).sample(failures.mutants, 40))
    print(f"{noticed} of 40 entries turned over were noticed")
    assert noticed >= 0.15 * 40
