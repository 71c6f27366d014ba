# SPDX-License-Identifier: BSD-2-Clause
"""``python -m soc.gateware_seeds BOARD``: place and route with several seeds, to see what the timing owes to luck.

Prints frequency and slack of each, writes ``build/<board>/seeds.json``, and fails if any misses.
"""

import argparse
import json
from concurrent.futures import ThreadPoolExecutor

from soc import gateware
from soc import gateware_report as reporting
from tb import toolchain

__all__ = ["table"]

SEEDS = range(1, 6)
AT_ONCE = 2
"""Routes at a time: each takes a processor and some 600 MB."""


def table(reports):
    """Text: one line for each seed, and the worst of all."""
    names = list(reporting.DOMAINS)
    lines = ["seed  " + "  ".join(f"{name:>5} MHz    slack" for name in names) + "  crossing"]
    for r in reports:
        cells = "  ".join(f"{r['fmax_mhz'][name]:9.1f}  {r['slack_ns'][name]:+4.2f} ns" for name in names)
        lines.append(f"{r['seed']:4}  {cells}  {r['crossing_ns_max']:5.2f} ns{'  MISSED' * bool(reporting.missed(r))}")
    for name in names:
        worst, wanted = min(r["fmax_mhz"][name] for r in reports), reports[0]["wanted_mhz"][name]
        lines.append(f"{name}: at least {worst:.1f} MHz of {wanted:.0f}, {100 * (worst / wanted - 1):+.1f} %")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], prog="make gateware-seeds")
    parser.add_argument("board", help=", ".join(sorted(gateware.boards())))
    board = gateware.board(parser.parse_args().board)

    def flow(seed):
        return gateware.Flow(board, say=lambda sentence: print(f"seed {seed} {sentence}", flush=True))

    with ThreadPoolExecutor(AT_ONCE) as pool:
        reports = list(pool.map(lambda seed: flow(seed).report(seed), SEEDS))
    (toolchain.BUILD / board.name / "seeds.json").write_text(json.dumps(reports, indent=1) + "\n")
    print(table(reports))
    if any(map(reporting.missed, reports)):
        raise SystemExit("timing missed")


if __name__ == "__main__":
    main()
