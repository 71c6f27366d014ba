# SPDX-License-Identifier: BSD-2-Clause
"""Verilog of the top ``abbe`` to a fast simulator: a shared library, built once per content under ``build/sim``.

The model and the loop around it are cached apart: a change of the board model or of the loop does not compile the
Verilog again.  Firmware and boot images are no part of either; they load at run time.
"""

import sys
from pathlib import Path

from tb import toolchain
from tb.board import board
from tb.board.library import build as build_library
from tb.board.library import cached

HERE = Path(__file__).parent
TB = HERE.parent
SOURCES = [HERE / "simulator.cpp", TB / "board" / "serial_line.cpp", *board.SOURCES]
HEADERS = [HERE / "simulator.h", TB / "board" / "serial_line.h", *board.HEADERS]
TOP = "abbe"

VERILATOR_FLAGS = [
    "--cc", "--build", "-j", "2", "--top-module", TOP, "--prefix", f"V{TOP}", "-O3",
    "--x-assign", "fast", "--x-initial", "fast", "--no-assert", "--no-timing", "--timescale", "1ps/1ps",
    "-Wno-lint", "-Wno-fatal", "-CFLAGS", "-fPIC -fvisibility=hidden",
]
# Verilator's run-time headers do not stand up to our own warnings; the board's headers are found as "board/...".
LOOP_FLAGS = ["-DVL_TIME_CONTEXT", "-Wno-conversion", "-Wno-sign-conversion", "-Wl,--no-undefined", "-pthread"]


def verilator_root():
    return Path(toolchain.environment()["VERILATOR_ROOT"])


def build_model(verilog):
    """Directory of the Verilated model of these Verilog files: headers and archives."""
    version = toolchain.run(["verilator", "--version"])
    directory = toolchain.BUILD / "sim" / toolchain.content_key(version, " ".join(VERILATOR_FLAGS), *verilog)
    with cached(directory) as empty:
        if empty:
            toolchain.run(["verilator", *VERILATOR_FLAGS, "--Mdir", directory, *verilog],
                          log=directory / "verilator.log")
    return directory


def build(verilog):
    """Path of the simulator library for a list of Verilog files that make up the top ``abbe``."""
    model = build_model([Path(file).resolve() for file in verilog])
    include = verilator_root() / "include"
    return build_library(
        "simulator", [*SOURCES, model / f"V{TOP}__ALL.a", model / "libverilated.a"], headers=HEADERS,
        flags=[f"-I{TB}", "-isystem", include, "-isystem", include / "vltstd", "-isystem", model, *LOOP_FLAGS])


if __name__ == "__main__":
    print(build(sys.argv[1:]))
