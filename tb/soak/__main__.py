# SPDX-License-Identifier: BSD-2-Clause
"""``make soak [COMMANDS= SPEED=]``: commands without a pause into the virtual controller, each to be answered once and in order.

The last line has the figures; status 1 and what was wrong if anything was.
"""

import argparse
import random
import socket
import sys

from tb.soak.soak import Wrong, soak
from tb.twin.twin import Twin


def show(figures):
    print(figures, file=sys.stderr, flush=True)


def main():
    parser = argparse.ArgumentParser(prog="make soak", description=__doc__.split("\n\n")[0])
    parser.add_argument("--commands", type=int, default=1_000_000, help="how many (default %(default)d)")
    parser.add_argument("--speed", type=float, default=20, help="times real time, as far as the machine can (default %(default)g)")
    parser.add_argument("--seed", type=int, help="of the commands; default: any")
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.randrange(1 << 32)
    with Twin(speed=options.speed) as twin, socket.create_connection(("127.0.0.1", twin.tcp_port)) as line:
        try:
            figures = soak(line, options.commands, seed=seed, progress=show)
        except Wrong as wrong:
            print(f"wrong, with --seed {seed}: {wrong}")
            return 1
    print(f"{figures}; each answered once and in order (seed {seed})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
