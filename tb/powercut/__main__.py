# SPDX-License-Identifier: BSD-2-Clause
"""``make powercut``: the power fails at every step of everything the controller does to its flash.

A line for each scenario, and at the end how many cuts passed; status 1 if any failed.
"""

import argparse
import sys
import time

from tb.firmware.host import build
from tb.powercut.powercut import Broken, Cuts, run, scenarios


def main():
    parser = argparse.ArgumentParser(prog="make powercut", description=__doc__.split("\n\n")[0])
    parser.add_argument("scenarios", nargs="*", metavar="SCENARIO", help="default: all")
    parser.add_argument("--pairs", type=int, default=4, help="second cuts after each (default %(default)d)")
    parser.add_argument("--every", type=int, default=1, help="cut before each so many steps only (default: all)")
    parser.add_argument("--seed", type=int, default=1, help="of what a cut leaves (default %(default)d)")
    options = parser.parse_args()
    program = build("powercut/powercut")
    known = scenarios(program)
    if unknown := set(options.scenarios) - set(known):
        parser.error(f"expected {', '.join(known)}, not {', '.join(sorted(unknown))}")
    total = Cuts()
    for name in options.scenarios or known:
        began = time.monotonic()

        def show(cuts):
            print(f"\r{name}: {cuts}", end="", file=sys.stderr, flush=True)

        try:
            cuts = run(program, name, every=options.every, pairs=options.pairs, seed=options.seed, progress=show)
        except Broken as broken:
            print(f"\n{broken}", file=sys.stderr)
            return 2
        print("\r", end="", file=sys.stderr, flush=True)
        print("\n".join([*cuts.failures[:20], f"{name}: {cuts}, {time.monotonic() - began:.0f} s"]), flush=True)
        total += cuts
    print(total)
    return 1 if total.failed else 0


if __name__ == "__main__":
    sys.exit(main())
