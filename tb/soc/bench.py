# SPDX-License-Identifier: BSD-2-Clause
"""Run a bare program on the SoC alone: builds the program and the loop (``bench.cpp``), decodes what comes out."""

import struct
import subprocess
from bisect import bisect_right
from pathlib import Path

from soc import generate, verilog
from tb import toolchain
from tb.sim.build import build_model

HERE = Path(__file__).parent
BUILD = toolchain.BUILD / "soc-bench"
CFLAGS = ["--specs=picolibc.specs", "-march=rv32im", "-mabi=ilp32", "-misa-spec=2.2", "-nostartfiles", "-std=c11",
          "-O2", "-ffreestanding", "-fno-delete-null-pointer-checks", "-Wall", "-Wextra", "-Wconversion", "-Wmissing-prototypes", "-Werror",
          "--param=min-pagesize=0"]


def words(image):
    """A binary image as the hexadecimal text that ``$readmemh`` loads: 32-bit words, little endian."""
    image += bytes(-len(image) % 4)
    return "".join(f"{word:08x}\n" for (word,) in struct.iter_unpack("<I", image))


def build_program(name="program"):
    """Compile ``program/<name>.c`` for the boot region; returns the path of its hexadecimal image."""
    sources = [HERE / "program" / "start.S", HERE / "program" / f"{name}.c"]
    generated = generate.files()
    parts = [generated["build/generated/regs.h"], generated["build/generated/memory.ld"], " ".join(CFLAGS),
             *sources, HERE / "program" / "link.ld", HERE / "program" / "hal" / "mmio.h"]
    directory = BUILD / toolchain.content_key(*parts)
    with toolchain.cached(directory) as empty:
        if empty:
            _compile(directory, generated, sources)
    return directory / "program.hex"


def _compile(directory, generated, sources):
    for name in "regs.h", "memory.ld":
        (directory / name).write_text(generated[f"build/generated/{name}"])
    elf, image = directory / "program.elf", directory / "program.bin"
    toolchain.run(["riscv64-unknown-elf-gcc", *CFLAGS, f"-I{directory}", f"-I{HERE / 'program'}",
                   f"-L{directory}", "-T", HERE / "program" / "link.ld", "-o", elf, *sources])
    toolchain.run(["riscv64-unknown-elf-objcopy", "-O", "binary", elf, image])
    (directory / "program.hex").write_text(words(image.read_bytes()))


def build_bench():
    """Build the loop around the Verilated model; returns its path."""
    model = build_model(verilog.write(toolchain.BUILD / "soc"))
    source = HERE / "bench.cpp"
    directory = BUILD / toolchain.content_key(source, model.name)
    with toolchain.cached(directory) as empty:
        if empty:
            include = Path(toolchain.environment()["VERILATOR_ROOT"]) / "include"
            toolchain.run(["g++", "-std=c++17", "-O2", "-Wall", "-Wextra", "-I", model, "-isystem", include,
                           "-isystem", include / "vltstd", "-DVL_TIME_CONTEXT", "-o", directory / "bench", source,
                           model / "Vabbe__ALL.a", model / "libverilated.a", "-pthread"])
    return directory / "bench"


def run(clocks, *arguments, program="program"):
    """Run a program for a number of ``sync`` clocks; returns ``([(clock, pin, level)], clocks left out)``."""
    command = [build_bench(), *arguments, str(clocks), f"+boot={build_program(program)}"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    events = [(int(clock), pin, int(level)) for clock, pin, level in map(str.split, done.stdout.splitlines())]
    left_out = int(done.stderr.split("left out ")[1].split()[0])
    return events, left_out


def serial_text(events, divisor):
    """Decode the bytes on ``serial_tx``: 8N1 with ``divisor`` clocks a bit."""
    edges = [(clock, level) for clock, pin, level in events if pin == "serial_tx"]
    clocks = [clock for clock, _level in edges]

    def level_at(clock):
        return edges[bisect_right(clocks, clock) - 1][1]

    text, free_at = [], 0
    for at, level in edges:
        if level == 0 and at >= free_at:
            bits = [level_at(at + divisor * n + divisor // 2) for n in range(1, 10)]
            if not bits[8]:
                raise ValueError(f"no stop bit for the byte that starts at clock {at}")
            text.append(chr(sum(bit << n for n, bit in enumerate(bits[:8]))))
            free_at = at + divisor * 9 + divisor // 2
    return "".join(text)
