# SPDX-License-Identifier: BSD-2-Clause
"""A million pulses at the pin IN0, 100 000 a second, half of them within a clock of the threshold, while the host floods the
main port: firmware over the model of the gateware, against a walk in whole numbers."""

import os
import subprocess
from fractions import Fraction

from tb import toolchain
from tb.board import plant

PULSES = 1_000_000
THRESHOLD_FAST = 600                        # RT R=0.003
COUNTS_PER_UM = Fraction(45396, 1000)


def walk(letters, step, fence):
    """Where the target ends, from 0, and at which pulses the fence cut a step short."""
    at, cut = 0, []
    for n, letter in enumerate(letters):
        at += step if letter == "s" else -step
        if not -fence <= at <= fence:
            at = max(-fence, min(fence, at))
            cut.append(n)
    return at, cut


def test_a_million_pulses_at_the_pin_end_where_the_walk_does():
    seed = int(os.environ.get("SEED", "1"))
    print(f"seed {seed}")
    with toolchain.firmware_lock():
        toolchain.run(["make", "--no-print-directory", "-C", "firmware", "../build/twin/steps"], cwd=toolchain.ROOT)
    lines = "LR Z=0.05", "RT R=0.003", "LK R=1.7", "VB Z=3", "LK F=84", "R X=1.7 Y=-7.3"
    queries = "LK N? C? L?", "M X? Y?", "LK F=90", "LK X?"
    done = subprocess.run([toolchain.BUILD / "twin" / "steps", plant.render(plant.load(())), str(seed), str(PULSES),
                           str(THRESHOLD_FAST), *lines, "--", *queries], capture_output=True, text=True, timeout=550,
                          check=True)
    letters, numbers, places, *rest = done.stdout.split("\n")
    letters = letters.removeprefix("pulses ")
    # In hundredths of a micron: exact.
    x, x_cut = walk(letters, 17, 5000)
    y, y_cut = walk(letters, -73, 5000)
    clipped = len({*x_cut, *y_cut})
    print(f"{letters.count('s')} short, {letters.count('l')} long, {clipped} cut short")
    assert len(letters) == PULSES and PULSES // 20 < clipped < PULSES // 2
    assert numbers.split() == [":A", f"C={clipped}", "L=0", f"N={PULSES}"]
    for word, letter, hundredths in zip(places.split()[1:], "XY", (x, y)):
        name, user = word.split("=")
        count = Fraction(hundredths, 100) * COUNTS_PER_UM
        # The reply is in tenths of a micron, of the whole count below.
        assert name == letter and float(user) == round(float(count // 1 / COUNTS_PER_UM * 10), 3)
    assert [line.strip() for line in rest[:2]] == [":A", ":A I"]
