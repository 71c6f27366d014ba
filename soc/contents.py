# SPDX-License-Identifier: BSD-2-Clause
"""What block RAM holds when the FPGA starts, changed without placing and routing again.

The netlist is made with random contents, every 512 bits of which occur once.  After routing, project Trellis'
``ecpbram`` finds them in the configuration and puts the firmware in their place.  It does not say what it has not
found, so :class:`BlockRam` reads the result back, by a way of its own: where the random bits are in the
configuration as routed, there have to be the firmware's in the changed one, all of them.

Project Trellis' text configuration: ``.bram_init N``, then the 2048 words of 9 bits of block N, hexadecimal.  A
block of 18 kbit is used with words of 1, 2, 4, 9, 18 or 36 bits (Lattice FPGA-TN-02204, "ECP5 and ECP5-5G Memory
Usage Guide", table of configurations of the EBR); the narrow ones leave each ninth bit out.
"""

import re

from tb import toolchain

__all__ = ["BlockRam", "random_words", "replace", "write_words"]

BLOCK_WORDS, BLOCK_BITS = 2048, 9
WIDTHS = 1, 2, 4, 9, 18, 36
SIGNATURE = 64
"""Bits by which a column of random bits is recognised."""


def random_words(directory, name, *, words, seed):
    """Write ``<name>.hex`` of random 32-bit words into ``directory``, the same at every call; returns them."""
    toolchain.ecpbram(["-g", f"{name}.hex", "-s", seed, "-w", 32, "-d", words], cwd=directory)
    return read_words(directory / f"{name}.hex")


def read_words(path):
    """The 32-bit words of a hexadecimal file, one a line."""
    return [int(line, 16) for line in path.read_text().split()]


def write_words(path, words, *, count):
    """Write words to a hexadecimal file, and zeros up to ``count``."""
    if len(words) > count:
        raise ValueError(f"{len(words)} words do not fit a memory of {count}")
    path.write_text("".join(f"{word:08x}\n" for word in [*words, *[0] * (count - len(words))]))


def replace(directory, source, result, changes):
    """Write the text configuration ``result``, which is ``source`` with other contents of its block RAM.

    ``changes`` lists (hexadecimal file of the random words, of the new ones); all names are relative to ``directory``.
    """
    for n, (old, new) in enumerate(changes):
        step = result if n == len(changes) - 1 else f"{result}.{n}"
        toolchain.ecpbram(["-i", source, "-o", step, "-f", old, "-t", new], cwd=directory)
        if n:
            (directory / source).unlink()
        source = step


class BlockRam:
    """The block RAM of a text configuration.

    Parameters
    ----------
    text : str
        Of the configuration.
    """

    def __init__(self, text):
        self.blocks = {}
        for number, words in re.findall(r"^\.bram_init (\d+)\n([0-9a-f\s]*)", text, re.MULTILINE):
            self.blocks[int(number)] = [int(word, 16) for word in words.split()]
        for number, words in self.blocks.items():
            if len(words) != BLOCK_WORDS:
                raise ValueError(f"block RAM {number} has {len(words)} words, not {BLOCK_WORDS}")

    def column(self, number, width, bit, *, most=None):
        """Bit ``bit`` of the words of block ``number``, used with words of ``width`` bits; of the first ``most``.

        Returns an int, word 0 lowest, and how many bits that is.
        """
        words = self.blocks[number]
        if width < BLOCK_BITS:          # several words in eight of the nine bits
            words = words[:most and most * width // 8]
            bits = [word >> shift & 1 for word in words for shift in range(bit, 8, width)]
        else:                           # one word in several of nine bits
            step = width // BLOCK_BITS
            bits = [word >> bit % BLOCK_BITS & 1 for word in words[bit // BLOCK_BITS::step][:most]]
        return int("".join(map(str, reversed(bits))), 2), len(bits)

    def columns(self):
        """``(number, width, bit)`` of every column in every width."""
        return ((number, width, bit) for number in self.blocks for width in WIDTHS for bit in range(width))

    def read(self, routed, random):
        """The words of a memory in this configuration.

        Parameters
        ----------
        routed : BlockRam
            The configuration that holds the random words, from which this one was made.
        random : list of int
            Those words, 32 bits each.

        Raises :exc:`ValueError` unless every bit of every word is found, in one place.
        """
        count = len(random)
        slices = [int("".join(str(word >> bit & 1) for word in reversed(random)), 2) for bit in range(32)]
        places = {}
        for bit, column in enumerate(slices):
            for first in range(0, count, 512):
                places[column >> first & (1 << SIGNATURE) - 1] = bit, first
        found, seen = [0] * 32, [0] * 32
        for place in routed.columns():
            bit, first = places.get(routed.column(*place, most=SIGNATURE)[0], (None, 0))
            if bit is None:
                continue
            value, length = routed.column(*place)
            mask = (1 << length) - 1
            if value != slices[bit] >> first & mask:
                continue
            if seen[bit] >> first & mask:
                raise ValueError(f"bit {bit} of the words from {first} on is in two places")
            seen[bit] |= mask << first
            found[bit] |= self.column(*place)[0] << first
        if any(bits != (1 << count) - 1 for bits in seen):
            missing = sum(count - bits.bit_count() for bits in seen)
            raise ValueError(f"{missing} bits of {32 * count} are not in the block RAM of this configuration")
        texts = [f"{column:0{count}b}" for column in reversed(found)]
        return [int("".join(bits), 2) for bits in zip(*texts)][::-1]
