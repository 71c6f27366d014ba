# SPDX-License-Identifier: BSD-2-Clause
"""Verilog of the top ``abbe`` to a fast simulator: a shared library, built once per content under ``build/sim``.

The model and the loop around it are cached apart: a change of the board model or of the loop does not compile the
Verilog again.  Firmware and boot images are no part of either; they load at run time.
"""

import re
import sys
from pathlib import Path

from tb import toolchain
from tb.board import board
from tb.board.library import build as build_library

HERE = Path(__file__).parent
TB = HERE.parent
SOURCES = [HERE / "simulator.cpp", TB / "board" / "serial_line.cpp", TB / "board" / "nor.c", *board.SOURCES]
HEADERS = [HERE / "simulator.h", TB / "board" / "serial_line.h", TB / "board" / "nor.h", *board.HEADERS]
TOP = "abbe"

# -fno-expand and one output file: a tenth faster on this design, measured.
VERILATOR_FLAGS = [
    "--cc", "--build", "-j", "2", "--top-module", TOP, "--prefix", f"V{TOP}", "-O3",
    "--x-assign", "fast", "--x-initial", "fast", "--no-assert", "--no-timing", "--timescale", "1ps/1ps",
    "-fno-expand", "--output-split", "0", "-Wno-lint", "-Wno-fatal", "-CFLAGS", "-fPIC -fvisibility=hidden",
]
# Verilator's run-time headers do not stand up to our own warnings; the board's headers are found as "board/...".
LOOP_FLAGS = ["-DVL_TIME_CONTEXT", "-Wno-conversion", "-Wno-sign-conversion", "-Wl,--no-undefined", "-pthread"]


def verilator_root():
    return Path(toolchain.environment()["VERILATOR_ROOT"])


def split_vectors(source, directory):
    """Verilog with those vectors split into bits of which some bits make others; returns the new file.

    Verilator takes such a vector for a loop and evaluates it again and again; split, it sees through it, and an
    idle controller runs a fifth faster.  Relies on one declaration per line, as yosys writes them.
    """
    found = toolchain.run(["verilator", "--lint-only", "-Wno-fatal", "-Wno-lint", "-Wwarn-UNOPTFLAT", "--no-timing",
                           "--top-module", TOP, source])
    lines = source.read_text().splitlines(keepends=True)
    for number in map(int, re.findall(r"^%Warning-UNOPTFLAT: .*?:(\d+):\d+:", found, re.MULTILINE)):
        lines[number - 1] = re.sub(r"^(\s*wire \[.*) ;$", r"\1 /*verilator split_var*/ ;", lines[number - 1])
    result = directory / source.name
    result.write_text("".join(lines))
    return result


def model_directory(verilog):
    """Where the Verilated model of a Verilog file is, or will be: named by all that goes into it."""
    version = toolchain.run(["verilator", "--version"])
    return toolchain.BUILD / "sim" / toolchain.content_key(version, Path(__file__), Path(verilog))


def is_built(verilog):
    """Whether the model of a Verilog file is there, so that a simulator of it needs no minutes of building."""
    return (model_directory(verilog) / "done").exists()


def build_model(verilog):
    """Directory of the Verilated model of a Verilog file: headers and archives."""
    verilog = Path(verilog).resolve(strict=True)
    directory = model_directory(verilog)
    with toolchain.cached(directory) as empty:
        if empty:
            toolchain.run(["verilator", *VERILATOR_FLAGS, "--Mdir", directory, split_vectors(verilog, directory)],
                          log=directory / "verilator.log")
    return directory


def build(verilog):
    """Path of the simulator library for a Verilog file with the top ``abbe``."""
    model = build_model(verilog)
    include = verilator_root() / "include"
    return build_library(
        "simulator", [*SOURCES, model / f"V{TOP}__ALL.a", model / "libverilated.a"], headers=HEADERS,
        flags=[f"-I{TB}", "-isystem", include, "-isystem", include / "vltstd", "-isystem", model, *LOOP_FLAGS])


if __name__ == "__main__":
    print(build(sys.argv[1]))
