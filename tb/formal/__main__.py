# SPDX-License-Identifier: BSD-2-Clause
"""``python -m tb.formal [name...]``: run all proofs, or those whose names contain one of the words."""

import argparse
import importlib
import sys
from pathlib import Path

from tb.formal.proof import Proof, run

def proofs():
    """All proofs: every class with a ``block`` in the files of this folder, one file per block."""
    found = []
    for path in sorted(Path(__file__).parent.glob("[a-z]*.py")):
        if path.stem == "proof" or path.stem.startswith("test_"):
            continue
        module = importlib.import_module(f"tb.formal.{path.stem}")
        classes = [v for v in vars(module).values() if isinstance(v, type) and v.__module__ == module.__name__]
        found += [c for c in classes if issubclass(c, Proof) and c.block]
    return found


def main():
    parser = argparse.ArgumentParser(prog="python -m tb.formal", description="Prove the gateware.")
    parser.add_argument("name", nargs="*", help="run only proofs whose name contains one of these")
    words = parser.parse_args().name
    chosen = [p for p in proofs() if not words or any(w in p.name() for w in words)]
    if not chosen:
        names = ", ".join(p.name() for p in proofs())
        parser.error(f"no proof is called {' or '.join(words)}; there are {names}")
    failed = [p.name() for p in chosen if not run(p)]
    print(f"{len(chosen) - len(failed)} of {len(chosen)} proofs hold, "
          "their covers are reached and their bugs are found")
    sys.exit(f"failed: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
