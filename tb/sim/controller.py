# SPDX-License-Identifier: BSD-2-Clause
"""The whole controller, ready to simulate: gateware to Verilog, firmware to memory images.

What is up to date is not built again; the images are for ``$readmemh``, one for each memory of the SoC.
"""

import shutil
import struct
from dataclasses import dataclass
from pathlib import Path

from tb import toolchain
from tb.sim.build import is_built
from tb.sim.simulator import Simulator

BOOT, FIRMWARE = (toolchain.BUILD / "firmware" / name for name in ("boot.elf", "abbe.elf"))


@dataclass(frozen=True)
class Controller:
    """Files of one controller."""
    verilog: Path
    boot: Path
    firmware: Path

    def power_up(self, **arguments):
        """A new :class:`tb.sim.simulator.Simulator` of it; arguments for the board and the serial line."""
        return Simulator(verilog=self.verilog, boot=self.boot, firmware=self.firmware, **arguments)


def load_segments(elf):
    """``(physical address, bytes)`` of every part of a 32-bit little-endian ELF file that is loaded.

    Raises :exc:`ValueError` for any other file. (Executable and Linking Format, TIS 1.2, book I, chapter 2.)
    """
    if elf[:6] != b"\x7fELF\x01\x01":
        raise ValueError("expected a 32-bit little-endian ELF file")
    (table,), (size, count) = struct.unpack_from("<I", elf, 28), struct.unpack_from("<HH", elf, 42)
    for n in range(count):
        kind, offset, _, address, length = struct.unpack_from("<5I", elf, table + n * size)
        if kind == 1 and length:
            yield address, elf[offset:offset + length]


def hex_words(segments, address, size):
    """Text for ``$readmemh`` of the memory at ``address``: 32-bit words, up to the last that is loaded."""
    image, end = bytearray(size), 0
    for start, data in segments:
        at = start - address
        if 0 <= at < size:
            if at + len(data) > size:
                raise ValueError(f"{len(data)} bytes at {start:#x} do not fit the {size} bytes at {address:#x}")
            image[at:at + len(data)] = data
            end = max(end, at + len(data))
    return "".join(f"{word:08x}\n" for word, in struct.iter_unpack("<I", image[:(end + 3) // 4 * 4]))


def write_images(elves, directory):
    """``{plusarg: path}`` of the memory images of programs, boot program and application, one for each region of the SoC."""
    from soc.top import REGIONS
    segments = [segment for elf in elves for segment in load_segments(Path(elf).read_bytes())]
    for address, data in segments:
        if not any(region.address <= address < region.address + region.size for region in REGIONS):
            raise ValueError(f"{len(data)} bytes at {address:#x} belong to no memory")
    images = {region.plusarg: directory / f"{region.plusarg}.hex" for region in REGIONS}
    for region in REGIONS:
        images[region.plusarg].write_text(hex_words(segments, region.address, region.size))
    return images


def write_verilog(say):
    """Path of the gateware's Verilog; elaborates the design only if a source has changed, which takes seconds."""
    root, result = toolchain.ROOT, toolchain.BUILD / "soc" / "abbe.v"
    sources = [*root.glob("rtl/**/*.py"), *root.glob("soc/**/*.py"), *root.glob("soc/**/*.v"),
               root / "tb" / "toolchain.py", root / "requirements.txt"]
    key = toolchain.content_key(*sorted(sources))
    stamp = toolchain.BUILD / "sim" / "gateware.key"
    if not (result.exists() and stamp.exists() and stamp.read_text() == key):
        say("building the gateware")
        from soc import verilog
        stamp.unlink(missing_ok=True)
        verilog.write(result.parent)
        stamp.parent.mkdir(parents=True, exist_ok=True)
        stamp.write_text(key)
    return result


def build(say=lambda sentence: None):
    """Build what is missing or out of date; returns the :class:`Controller`.

    ``say(sentence)`` is told before the gateware is built, and when :meth:`Controller.power_up` will have to build
    its simulator; the firmware takes a moment only. The controller's files are copies, named by content: a later
    build does not change them under a running simulation.
    """
    with toolchain.firmware_lock():
        verilog = write_verilog(say)
        toolchain.run(["make", "--no-print-directory", "-C", "firmware"], cwd=toolchain.ROOT)
        directory = toolchain.BUILD / "sim" / "controller" / toolchain.content_key(verilog, BOOT, FIRMWARE)
        with toolchain.cached(directory) as empty:
            if empty:
                shutil.copy(verilog, directory)
                write_images([BOOT, FIRMWARE], directory)
    if not is_built(directory / "abbe.v"):
        say("building the simulator of this gateware, which takes minutes")
    return Controller(*(directory / name for name in ("abbe.v", "boot.hex", "firmware.hex")))
