# SPDX-License-Identifier: BSD-2-Clause
"""``python -m soc.programmer BOARD flash|program|check``: send ``build/<board>/abbe.bit`` to a board, by openFPGALoader.

``flash`` writes the configuration flash, which the FPGA loads at power-up; ``program`` the FPGA, until power-off.
``check`` sends nothing and says, before anything is built, if a board can never be sent to.
"""

import argparse
import hashlib
import json
import subprocess

from soc import gateware
from soc.top import REGIONS
from tb import toolchain

__all__ = ["explain", "main"]

TOOL = "openFPGALoader"
TESTED = "0.10.0"
"""Of Debian 12."""

CAUSES = {
    "device not found": "no board was found: is it connected by USB, and by the right one of its USB sockets?",
    "usb_open": "this user may not open the board: install openFPGALoader's udev rule or run this as root",
    "permission denied": "this user may not open the board: install openFPGALoader's udev rule or run this as root",
    "claim": "another program holds the board: close terminals on its serial port",
    "no such file": "the bitstream vanished: run make gateware again",
}
"""What openFPGALoader says in a failure, in small letters, and what to do."""


def explain(text):
    """A sentence on what openFPGALoader said when it failed."""
    return next((cause for sign, cause in CAUSES.items() if sign in text.lower()),
                "openFPGALoader failed; what it said is above")


def check(board):
    """Exits if no bitstream of this board can be sent, or would run."""
    if board.programmer is None:
        raise SystemExit(f"openFPGALoader does not know the board {board.name}")
    if board.ram_bytes < REGIONS[-1].size:
        raise SystemExit(f"{board.name} is a check of area and timing, this does not run: firmware is linked for "
                         f"{REGIONS[-1].size >> 10} KiB of RAM and there are {board.ram_bytes >> 10}")


def bitstream(board, directory):
    """The bitstream's path.  Exits unless it is that of the report beside it and made to run."""
    path, report = directory / "abbe.bit", directory / "report.json"
    if not path.exists() or not report.exists():
        raise SystemExit(f"there is no bitstream: run make gateware BOARD={board.name}")
    about = json.loads(report.read_text())
    if hashlib.sha256(path.read_bytes()).hexdigest() != about["bitstream_sha256"]:
        raise SystemExit(f"{path} is not that of {report.name}: run make gateware BOARD={board.name}")
    if not about["runs"]:
        raise SystemExit(f"not sent: {about['memory']}")
    return path


def command(board, path, way):
    """The command line."""
    return [TOOL, "--board", board.programmer, *(["--write-flash", "--verify"] if way == "flash" else ["--write-sram"]),
            str(path)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("board", help=", ".join(sorted(gateware.boards())))
    parser.add_argument("way", choices=["flash", "program", "check"])
    options = parser.parse_args()
    board = gateware.board(options.board)
    check(board)
    if options.way == "check":
        return
    path = bitstream(board, toolchain.BUILD / board.name)
    try:
        print(f"{TOOL} {version()} (tested: {TESTED})", flush=True)
        run = subprocess.run(command(board, path, options.way), text=True, stderr=subprocess.PIPE, check=False)
    except FileNotFoundError:
        raise SystemExit(f"{TOOL} is not installed; Debian's package is called openfpgaloader") from None
    print(run.stderr.rstrip(), flush=True)
    if run.returncode:
        raise SystemExit(f"{board.name}: {explain(run.stderr)}")


def version():
    """Of the openFPGALoader that is installed."""
    said = subprocess.run([TOOL, "--Version"], text=True, capture_output=True, check=False)
    return (said.stdout + said.stderr).strip().split()[-1].removeprefix("v")


if __name__ == "__main__":
    main()
