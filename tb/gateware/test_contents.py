# SPDX-License-Identifier: BSD-2-Clause
"""soc/contents.py: memories found in block RAM of every width, bit for bit; what is missing or double is an error."""

import random

import pytest

from soc import contents

COUNT = 2048


def configuration(blocks):
    """Text configuration of ``{number: [2048 words of 9 bits]}``."""
    lines = [".device LFE5U-25F", ""]
    for number, words in blocks.items():
        lines.append(f".bram_init {number}")
        lines += [" ".join(f"{w:03x}" for w in words[n:n + 8]) for n in range(0, len(words), 8)]
        lines.append("")
    return "\n".join([*lines, ".tile X", "arc: A B", ""])


def stored(words, width):
    """Blocks that hold ``words`` side by side, ``width`` bits of each word in a block.

    From the block's own point of view: bit n of its serial order is bit n % 9 of word n // 9, and words narrower than
    9 bits leave each ninth bit out.
    """
    taken = width // 9 * 8 or width
    blocks = {}
    for first in range(0, 32, taken):
        for low in range(0, len(words), depth := (16384 if width < 9 else 18432) // width):
            bits = [0] * (9 * 2048)
            for address, word in enumerate(words[low:low + depth]):
                for bit in range(taken):
                    serial = address * width + bit
                    place = serial // 8 * 9 + serial % 8 if width < 9 else serial
                    bits[place] = word >> first + bit & 1
            blocks[len(blocks)] = [sum(bits[9 * n + b] << b for b in range(9)) for n in range(2048)]
    return blocks


def words(seed, count=COUNT):
    rng = random.Random(seed)
    return [rng.getrandbits(32) for _ in range(count)]


@pytest.mark.parametrize("width", [1, 2, 4, 9, 18, 36])
def test_what_was_stored_is_read_in_every_width(width):
    count = max(COUNT, 16384 // width if width < 9 else 0)
    before, after = words(1, count), words(2, count)
    routed, changed = (contents.BlockRam(configuration(stored(w, width))) for w in (before, after))
    assert changed.read(routed, before) == after
    after[777] ^= 1 << 19
    assert changed.read(routed, before) != after


def test_a_bit_that_is_not_there_or_there_twice_is_an_error():
    before = words(1)
    blocks = stored(before, 9)
    routed = contents.BlockRam(configuration(blocks))
    assert routed.read(routed, before) == before
    part = contents.BlockRam(configuration({n: b for n, b in blocks.items() if n != 2}))
    with pytest.raises(ValueError, match=f"{8 * COUNT} bits of {32 * COUNT} are not in"):
        part.read(part, before)
    one_wrong = {n: [*b[:99], b[99] ^ 1, *b[100:]] if n == 3 else b for n, b in blocks.items()}
    with pytest.raises(ValueError, match=f"{COUNT} bits of"):
        contents.BlockRam(configuration(one_wrong)).read(contents.BlockRam(configuration(one_wrong)), before)
    double = contents.BlockRam(configuration({**blocks, 9: blocks[0]}))
    with pytest.raises(ValueError, match="in two places"):
        double.read(double, before)


def test_words_that_do_not_fit_are_refused(tmp_path):
    with pytest.raises(ValueError, match="3 words do not fit a memory of 2"):
        contents.write_words(tmp_path / "x.hex", [1, 2, 3], count=2)
    contents.write_words(tmp_path / "x.hex", [0xdeadbeef], count=3)
    assert contents.read_words(tmp_path / "x.hex") == [0xdeadbeef, 0, 0]


def test_a_block_of_another_size_is_refused():
    with pytest.raises(ValueError, match="block RAM 5 has 2047 words"):
        contents.BlockRam(configuration({5: [0] * 2047}))
