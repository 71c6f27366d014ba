# SPDX-License-Identifier: BSD-2-Clause
"""The controller, built from its sources where they changed, and powered up in the simulator."""

from __future__ import annotations

import struct
import sys
from pathlib import Path

from soc import verilog
from soc.top import REGIONS
from tb import toolchain
from tb.sim.simulator import Simulator

ELF = toolchain.BUILD / "firmware" / "abbe.elf"
LOADED = 1                                                   # a program header of type PT_LOAD


def power_up(plant_overrides=()) -> Simulator:
    """A simulated controller with today's gateware and firmware, at time 0."""
    say("gateware")
    design = verilog.write(toolchain.BUILD / "soc")
    say("firmware")
    toolchain.run(["make", "--no-print-directory", "-C", toolchain.ROOT / "firmware"])
    images = write_images(ELF, toolchain.BUILD / "firmware")
    say("simulator (minutes, when the gateware is new)")
    return Simulator(**images, verilog=[design], plant_overrides=plant_overrides)


def say(part: str):
    """What is being built: the first time takes minutes."""
    print(f"building if changed: {part}", file=sys.stderr, flush=True)


def write_images(elf: Path, directory: Path, regions=REGIONS) -> dict[str, Path]:
    """Split what an ELF file loads into one ``<plusarg>.hex`` for each memory region, as ``$readmemh`` reads it.

    Loads are placed by physical address. Raises :exc:`ValueError` for one that lies in no region.
    """
    contents = {region.plusarg: bytearray(region.size) for region in regions}
    for address, data in segments(elf.read_bytes()):
        region = next((r for r in regions if r.address <= address and address + len(data) <= r.address + r.size), None)
        if region is None:
            raise ValueError(f"{elf} loads {len(data)} bytes at {address:#x}, in no memory region")
        offset = address - region.address
        contents[region.plusarg][offset:offset + len(data)] = data
    files = {}
    for plusarg, content in contents.items():
        used = len(content.rstrip(b"\0")) + 3 & ~3 or 4
        files[plusarg] = directory / f"{plusarg}.hex"
        files[plusarg].write_text("".join(f"{word:08x}\n" for (word,) in struct.iter_unpack("<I", content[:used])))
    return files


def segments(elf: bytes):
    """(physical address, bytes) of every loaded segment of a 32-bit little-endian ELF file.

    Layout: Tool Interface Standard, Executable and Linking Format 1.2, part 1, figures 1-3 and 2-1.
    """
    if elf[:6] != b"\x7fELF\x01\x01":
        raise ValueError(f"expected a 32-bit little-endian ELF file, not one that starts with {elf[:6]!r}")
    table, = struct.unpack_from("<I", elf, 28)
    entry_size, entries = struct.unpack_from("<HH", elf, 42)
    for i in range(entries):
        kind, offset, _, physical, size = struct.unpack_from("<5I", elf, table + i * entry_size)
        if kind == LOADED and size:
            yield physical, elf[offset:offset + size]
