# SPDX-License-Identifier: BSD-2-Clause
"""``python -m tb.formal [name...]``: run all proofs, or those whose names contain one of the words."""

import argparse
import importlib
import sys

from tb.formal.proof import Proof, run

FILES = ["crossing", "quadrature", "snapshot"]
"""Files of this folder that hold proofs, by the block they are about."""


def proofs():
    """All proofs, in the order written."""
    found = []
    for file in FILES:
        module = importlib.import_module(f"tb.formal.{file}")
        found += [v for v in vars(module).values()
                  if isinstance(v, type) and issubclass(v, Proof) and v.__module__ == module.__name__ and v.block]
    return found


def main():
    parser = argparse.ArgumentParser(prog="python -m tb.formal", description="Prove the gateware.")
    parser.add_argument("name", nargs="*", help="run only proofs whose name contains one of these")
    words = parser.parse_args().name
    chosen = [p for p in proofs() if not words or any(w in p.name() for w in words)]
    if not chosen:
        parser.error(f"no proof is called {' or '.join(words)}; there are {', '.join(p.name() for p in proofs())}")
    failed = [p.name() for p in chosen if not run(p)]
    print(f"{len(chosen) - len(failed)} of {len(chosen)} proofs hold, their covers are reached and their bugs are found")
    sys.exit(f"failed: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
