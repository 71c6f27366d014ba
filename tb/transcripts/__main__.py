# SPDX-License-Identifier: BSD-2-Clause
"""``make test-transcripts [PORT=...] [FILES=...]``: transcripts against a controller; last line ``N passed, M failed``.

PORT is a device, a pty or ``host:port`` (TCP); without it the virtual controller is run (:mod:`tb.twin`).
"""

import argparse
import contextlib
import re
import sys

import serial

from tb.transcripts.runner import VECTORS, Host, Session
from tb.transcripts.transcript import VARIANTS
from tb.twin.twin import Twin

TWIN_SPEED = 10     # times real time


def open_port(name, baud):
    """A pyserial port for a path or ``host:port``."""
    if re.fullmatch(r"[\w.-]+:\d+", name):
        name = f"socket://{name}"
    return serial.serial_for_url(name, baudrate=baud, timeout=0.02)


def files(names):
    """Paths of transcripts given by path or by name; none given: all."""
    paths = [VECTORS / f"{name}.txt" if (VECTORS / f"{name}.txt").exists() else name for name in names]
    return paths or sorted(VECTORS.glob("*.txt"))


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="make test-transcripts", description=__doc__.split("\n\n")[0])
    parser.add_argument("files", nargs="*", help="transcripts, by path or name (default: all)")
    parser.add_argument("--port", help="device, pty, or host:port")
    parser.add_argument("--baud", type=int, default=115200)
    parser.add_argument("--patience", type=float, default=2.0, help="seconds a reply may take (default %(default)g)")
    parser.add_argument("--as", dest="names", action="append", default=[],
                        choices=[*VARIANTS, "doubled", "mirrored"], help="say it as other hosts do; may be repeated")
    options = parser.parse_args(arguments)
    with contextlib.ExitStack() as resources:
        name = options.port or resources.enter_context(Twin(speed=TWIN_SPEED)).port
        port = resources.enter_context(open_port(name, options.baud))
        host = Host(port, patience=options.patience, quiet=0.02 * max(1, options.patience / 2))
        session = Session(host, names=options.names, say=print)
        for path in files(options.files):
            session.run(path)
    result = session.result
    for module in sorted({module for _, module in result.deferred}):
        count = sum(module == m for _, m in result.deferred)
        print(f"{count} deferred: they wait for the module {module}")
    if result.inapplicable:
        print(f"{result.inapplicable} not applicable: the controller has other axes")
    print(result)
    return 1 if result.failures else 0


if __name__ == "__main__":
    sys.exit(main())
