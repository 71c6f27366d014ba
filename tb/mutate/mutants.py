# SPDX-License-Identifier: BSD-2-Clause
"""Mutants of a block: its design with one cell wrong, all of them in one simulation; and what notices them.

yosys chooses them (``mutate -list``): an input or output of a cell inverted, stuck at 0 or 1, or inverted while another bit
is 0 or 1.  It mutates the cells of the source, before anything is optimised or mapped.  A number at the simulation's start
(``+mutant=<n>``) chooses one; without it the design is as it should be.

A proof knows a mutant by the same names: the block inside it is made of the same modules, whose cells are numbered alike.
"""

import re
from pathlib import Path

from tb import toolchain, verilated
from tb.formal import proof as formal

__all__ = ["build", "is_equivalent", "listed", "noticed_by_proof", "noticed_by_tests"]

FIRST_NUMBER = 1_000_000
"""From here on yosys numbers the cells that it makes itself, in the block alone as inside a proof."""


def _write(directory, name, rtlil):
    (directory / name).write_text(f"autoidx {FIRST_NUMBER}\n{rtlil}")


def _modules(directory, name, part):
    """Modules of an RTLIL file that are ``part`` or inside it, in their order.

    A module whose name a signal has as well bears a number behind it.
    """
    names = re.findall(r"^module \\(\S+)$", (directory / name).read_text(), re.MULTILINE)
    chosen = [module for module in names if re.match(rf"{re.escape(part)}(\$\d+)?(\.|$)", module)]
    if not chosen:
        raise ValueError(f"no module is called {part}; there are {', '.join(names)}")
    return chosen


def _cells(directory, name, part):
    """yosys commands that read a file and make cells of ``part`` alone."""
    return f"read_rtlil {name}; proc {' '.join(_modules(directory, name, part))}"


def build(rtlil, part, *, count, seed=1):
    """Directory of a simulation of ``dut`` with ``count`` mutants of its module ``part``, made once.

    ``count`` must not be more than there are, or yosys never ends.
    """
    bits = count.bit_length()

    def write_sources(directory):
        _write(directory, "dut.il", rtlil)
        modules = " ".join(_modules(directory, "dut.il", part))
        toolchain.yosys(
            f"{_cells(directory, 'dut.il', part)}; opt_clean {modules}; "
            f"mutate -list {count} -seed {seed} -ctrl mutant {bits} 1 -o mutants.ys {modules}; "
            "hierarchy -top dut; proc; script mutants.ys; opt_clean; memory_collect; write_verilog -noattr dut.v",
            cwd=directory)
        path = directory / "dut.v"
        text, changed = re.subn(
            r"^(module dut\([^)]*), mutant\);$(.*?)^  input \[\d+:0\] mutant;\n  wire (\[\d+:0\] mutant);$",
            r'\1);\2  reg \3;' "\n" r'  initial if (!$value$plusargs("mutant=%d", mutant)) mutant = 0;',
            path.read_text(), flags=re.MULTILINE | re.DOTALL)
        if changed != 1:
            raise RuntimeError(f"{path} does not know its mutants")
        path.write_text(text)
        return [path]
    name = toolchain.content_key(rtlil, part, f"{count} {seed}", Path(__file__), Path(verilated.__file__))
    return verilated.build(f"mutants-{name}", write_sources)


def listed(directory):
    """``{number: "-mode ... -module ... -cell ..."}`` of a simulation."""
    lines = (directory / "mutants.ys").read_text().splitlines()
    return {int(n): how for n, how in (re.match(r"mutate -ctrl mutant \d+ (\d+) (.*)", line).groups() for line in lines)}


def noticed_by_tests(directory, number, suites):
    """The first test that fails with this mutant, or None.  ``suites``: ``[(module, regular expression, environment)]``."""
    for module, tests, env in suites:
        try:
            failed = verilated.failures(directory, module, label=f"mutant-{number}", tests=tests,
                                        env={"COCOTB_MAX_FAILURES": "1", **env}, plusargs=[f"+mutant={number}"])
        except RuntimeError:            # Verilator stops where two cases of one hold, which are exclusive
            return "simulation"
        if failed:
            return failed[0]
    return None


def is_equivalent(directory, part, how):
    """Whether yosys proves that this mutant is the same circuit: ``part`` by itself, register by register, by induction.

    If not at once, then with registers that stay what they are at reset, as inputs are tied to a level, taken for constants.
    """
    top, = (module for module in _modules(directory, "dut.il", part) if re.fullmatch(rf"{re.escape(part)}(\$\d+)?", module))
    for constants in "", "opt_expr; opt_dff -sat; opt_expr; opt_dff -sat; ":
        finish = f"hierarchy -top {top}; proc; flatten; memory_collect; memory_map; {constants}opt_clean"
        try:
            toolchain.yosys(
                f"{_cells(directory, 'dut.il', part)}; design -save cells; {finish}; rename {top} gold; design -stash gold; "
                f"design -load cells; mutate {how}; {finish}; rename {top} gate; design -copy-from gold gold; "
                "equiv_make gold gate equiv; hierarchy -top equiv; opt_clean; equiv_simple; equiv_induct -seq 3; "
                "tee -q -o equivalence.txt equiv_status", cwd=directory)
        except RuntimeError:                # a register that is stuck at what it is not at reset
            return False
        if "Equivalence successfully proven!" in (directory / "equivalence.txt").read_text():
            return True
    return False


def _named_cells(directory, name, modules):
    """``[(module, type, cell)]`` of an RTLIL file before yosys adds its own."""
    text = (directory / name).read_text()
    found = []
    for module in modules:
        body = re.search(rf"^module \\{re.escape(module)}$.*?^end$", text, re.MULTILINE | re.DOTALL)[0]
        found += [(module, kind, cell) for kind, cell in re.findall(r"^  cell (\S+) \\?(\S+)$", body, re.MULTILINE)]
    return found


def _in_the_proof(how, outside, inside):
    """The same mutant of the block inside a proof, whose cells come in the same order under other numbers.

    Raises :exc:`RuntimeError` if they are not the same cells.
    """
    if [kind for _, kind, _ in outside if kind[0] == "$"] != [kind for _, kind, _ in inside if kind[0] == "$"]:
        raise RuntimeError(f"{outside[0][0]} has other cells in the proof")
    module, cell = re.search(r"-module (\S+) -cell (\S+)", how).groups()
    there = {(m, c): (p, d) for (m, _, c), (p, _, d) in zip(outside, inside, strict=True)}
    modules = {m: p for (m, _), (p, _) in there.items()}
    to_module, to_cell = there.get((module, cell), (modules[module], cell))
    return how.replace(f"-module {module} -cell {cell}", f"-module {to_module} -cell {to_cell}")


def noticed_by_proof(proof, directory, part, how):
    """Whether the claim of a proof of the block ``part``, which is ``dut`` in its harness, no longer holds with this mutant.

    Raises :exc:`RuntimeError` if the block's cells are not the same in both.
    """
    if re.search(r"-port (\w+_)?(clk|rst) ", how):      # of a module inside; the proof has other names for them
        return False
    name = f"mutant-{proof.name()}"
    folder = toolchain.BUILD / "formal" / name
    with toolchain.exclusive(folder / "mutate.lock"):
        _write(folder, "whole.il", proof().rtlil())
        outside = _named_cells(directory, "dut.il", _modules(directory, "dut.il", part))
        inside = _named_cells(folder, "whole.il", _modules(folder, "whole.il", "top.dut"))
        toolchain.yosys(f"{_cells(folder, 'whole.il', 'top.dut')}; mutate {_in_the_proof(how, outside, inside)}; "
                        "write_rtlil mutated.il", cwd=folder)
        verdict, _seconds, _log = formal.check(name, proof.mode, proof.depth, (folder / "mutated.il").read_text())
    return verdict in ("FAIL", "UNKNOWN")
