# SPDX-License-Identifier: BSD-2-Clause
"""``make mutate``: how many of the ways in which a timing block can be wrong do its tests and proofs notice?

Of each block 200 mutants, or all if it has fewer, are tried, one after the other, on its tests; those that no test notices
are compared with the block itself, which some of them are in another form, and put to its proofs.  Ends with 1 if of those
that are not the same less than 95 % are noticed.  Writes ``build/mutate/report.json``, which lists the ones left alive.
"""

import argparse
import importlib
import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor

from tqdm import tqdm

from tb import toolchain
from tb.mutate import mutants
from tb.mutate.blocks import BLOCKS

WANTED = 0.95


def _be_quiet():
    """A worker's first step: cocotb's tests print a page each."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)


def _noticed(directory, number, suites):
    sys.path.insert(0, str(toolchain.ROOT / "tb" / "rtl"))
    loaded = [(importlib.import_module(suite.file), suite.tests, dict(suite.env)) for suite in suites]
    return number, mutants.noticed_by_tests(directory, number, loaded)


def examine(block, pool, *, count):
    """``{"mutants", "tests", "proofs", "equivalent", "alive": [how]}`` of a block."""
    directory = mutants.build(toolchain.to_rtlil(block.make()), block.part, count=count)
    how = mutants.listed(directory)
    if failed := pool.submit(_noticed, directory, 0, block.suites).result()[1]:
        raise RuntimeError(f"{block.name}: {failed} fails without a mutant")
    tasks = [pool.submit(_noticed, directory, number, block.suites) for number in how]
    left = []
    for task in tqdm(tasks, desc=f"{block.name}, tests", leave=False, dynamic_ncols=True, disable=None):
        number, test = task.result()
        if not test:
            left.append(number)
    alive, equivalent = [], 0
    for number in tqdm(left, desc=f"{block.name}, proofs", leave=False, dynamic_ncols=True, disable=None):
        if mutants.is_equivalent(directory, block.part, how[number]):
            equivalent += 1
        elif not any(mutants.noticed_by_proof(proof, directory, block.part, how[number]) for proof in block.proofs):
            alive.append(how[number])
    return {"mutants": len(how), "tests": len(how) - len(left), "proofs": len(left) - equivalent - len(alive),
            "equivalent": equivalent, "alive": alive}


def share(found):
    """Of the mutants that are other circuits, the share that was noticed."""
    return (found["tests"] + found["proofs"]) / max(1, found["mutants"] - found["equivalent"])


def main():
    parser = argparse.ArgumentParser(prog="python -m tb.mutate", description="Do tests and proofs notice a wrong block?")
    parser.add_argument("name", nargs="*", help=f"blocks: {', '.join(b.name for b in BLOCKS)}; default: all")
    parser.add_argument("--mutants", type=int, default=200, help="of each block, 200 by default")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="at a time; default: one per processor")
    options = parser.parse_args()
    if unknown := set(options.name) - {b.name for b in BLOCKS}:
        parser.error(f"no block is called {', '.join(sorted(unknown))}; there are {', '.join(b.name for b in BLOCKS)}")
    toolchain.activate()
    report, good = {}, True
    print(f"{'block':<12}{'mutants':>8}{'by tests':>10}{'by proofs':>10}{'the same':>10}{'alive':>7}{'noticed':>9}")
    with ProcessPoolExecutor(options.jobs, initializer=_be_quiet) as pool:
        for block in BLOCKS:
            if options.name and block.name not in options.name:
                continue
            report[block.name] = found = examine(block, pool, count=min(options.mutants, block.most))
            good &= share(found) >= WANTED
            print(f"{block.name:<12}{found['mutants']:>8}{found['tests']:>10}{found['proofs']:>10}"
                  f"{found['equivalent']:>10}{len(found['alive']):>7}{share(found):>9.1%}", flush=True)
            for how in found["alive"]:
                print(f"    alive: {how}")
    path = toolchain.BUILD / "mutate" / "report.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(report, indent=1) + "\n")
    print(f"wrote {path.relative_to(toolchain.ROOT)}")
    sys.exit(0 if good else f"less than {WANTED:.0%} noticed")


if __name__ == "__main__":
    main()
