# SPDX-License-Identifier: BSD-2-Clause
"""The netlist of a whole board as the flow makes it, ready to simulate, with firmware in its block memory.

Nothing is synthesised here and nothing left out: the netlist is that which goes to place and route.  It has the random
contents of :mod:`soc.contents`; firmware takes their place by the tool that puts it into the bitstream, on a
configuration that holds the block memory and nothing else, and is read back by the same check.  The simulation loads
it when it starts, so new firmware compiles nothing.
"""

import json
import re
from pathlib import Path

from soc import contents, gateware
from tb import toolchain
from tb.gates import netlist

__all__ = ["Product"]

INITVAL = [f"INITVAL_{n:02X}" for n in range(64)]
"""Parameters of DP16KD: 16 words of 18 bits each, two bits between them, the lowest word first."""


class Product:
    """A board's netlist.

    Parameters
    ----------
    name : str
        Of the board.
    mutable : str
        Regular expression: of the LUTs whose instance it finds, the first in order of name can be inverted, as
        number 0 of ``models/mutable_lut4.v``.
    """

    def __init__(self, name, *, mutable):
        self.board, self._mutable = gateware.board(name), mutable
        self.directory = gateware.Flow(self.board, say=print).netlist()

    def simulation(self):
        """Its directory, as :func:`tb.gates.netlist.simulation` says; the top is ``dut``."""
        source = self.directory / "top.json"

        def write_sources(directory):
            (directory / "top.json").write_bytes(source.read_bytes())
            path = netlist.write(directory, "read_json top.json")
            path.write_text(self._prepared(path.read_text()))
            return [path]
        # -O3 takes minutes longer to compile.
        return netlist.simulation(netlist.content_key(source, self._mutable, Path(__file__)), write_sources, timing=True,
                                  arguments=["-CFLAGS", "-O1"])

    def _prepared(self, text):
        """The netlist with a number for every block memory, and with its mutable LUT."""
        numbers = {name: number for number, (name, _) in enumerate(self._blocks())}

        def numbered(instance):
            return f"  DP16KD #( .NUMBER({numbers[instance[2].removeprefix(chr(92))]}),{instance[1]}{instance[2]} "

        text, found = re.subn(r"^  DP16KD #\((.*?\n  \) )(\S+) ", numbered, text, flags=re.MULTILINE | re.DOTALL)
        assert found == len(numbers)
        luts = re.findall(r"^  LUT4 #\(\n[^\n]*\n  \) (\S+) ", text, re.MULTILINE)
        chosen = re.escape(min(name for name in luts if re.search(self._mutable, name)))
        return re.sub(rf"^  LUT4 (#\(\n[^\n]*\n  \) {chosen} )", r"  MUTABLE_LUT4 \1", text, flags=re.MULTILINE)

    def _blocks(self):
        """``[(name, parameters)]`` of the block memory."""
        cells = json.loads((self.directory / "top.json").read_text())["modules"]["top"]["cells"]
        return [(name, cell["parameters"]) for name, cell in cells.items() if cell["type"] == "DP16KD"]

    def memory(self, words):
        """A directory for ``+bram=`` with ``words``, ``{region's name: [32 bits]}``.

        Raises :exc:`ValueError` if the random contents are not all found, and :exc:`RuntimeError` if what takes their
        place is not ``words``.
        """
        directory = toolchain.BUILD / "cocotb" / ("bram-" + toolchain.content_key(
            self.directory / "top.json", json.dumps(words)))
        with toolchain.cached(directory) as empty:
            if empty:
                self._write_memory(directory, words)
        return directory

    def _write_memory(self, directory, words):
        words_of = (block_words(parameters) for _, parameters in self._blocks())
        (directory / "random.config").write_text(configuration(self.board.device, words_of))
        changes = []
        for region in self.board.regions():
            changes.append((f"{region.name}.random.hex", f"{region.name}.hex"))
            (directory / changes[-1][0]).write_bytes((self.directory / f"{region.name}.hex").read_bytes())
            contents.write_words(directory / changes[-1][1], words[region.name], count=region.size // 4)
        contents.replace(directory, "random.config", "abbe.config", changes)
        random, placed = (contents.BlockRam((directory / f"{name}.config").read_text()) for name in ("random", "abbe"))
        for old, new in changes:
            if placed.read(random, contents.read_words(directory / old)) != contents.read_words(directory / new):
                raise RuntimeError(f"{new} is not what the block memory holds")
        for number, block in placed.blocks.items():
            pairs = zip(block[::2], block[1::2])
            (directory / f"{number}.hex").write_text("".join(f"{high << 9 | low:05x}\n" for low, high in pairs))


def block_words(parameters):
    """The 2048 words of 9 bits of a DP16KD."""
    result = []
    for name in INITVAL:
        value = int(parameters[name].replace("x", "0"), 2)
        result += [value >> at & 0x1ff for n in range(16) for at in (20 * n, 20 * n + 9)]
    return result


def configuration(device, blocks):
    """Project Trellis' text configuration of block memory, and of nothing else."""
    lines = [f".device {device}"]
    for number, words in enumerate(blocks):
        lines += ["", f".bram_init {number}", *(" ".join(f"{word:03x}" for word in words[at:at + 8])
                                                for at in range(0, len(words), 8))]
    return "\n".join(lines) + "\n"
