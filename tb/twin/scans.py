# SPDX-License-Identifier: BSD-2-Clause
"""Whole scans on the virtual controller, without a host and without real time: tb/twin/scans.cpp, and its exact model.

The stage does what it is told (tb/twin/follower.h), so a line is a straight line in time, known but for its phase, and the
exact model of its pulses is a rounded-up quotient: encoder edge e is sampled at the first clock of ``fast`` at or after
``a + e * 2^32 * 20000 / v``, v the set-point's step in 2^-32 counts a servo tick of 20000 clocks, and shows at the pins 10
clocks later. The phase a must be the same for SYNC and every pixel of the line.
"""

import subprocess
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from tb import toolchain
from tb.board import plant
from tb.firmware.host import build

COUNTS_PER_MM = 45396
TICK_CLOCKS = 20_000
LATENCY_CLOCKS = 10


@dataclass(frozen=True)
class Field:
    """Of ``lines`` lines of ``length`` mm; numbers as text are sent as such."""
    n: str = "24"
    speed: str = "0.528"
    length: str = "1.0"
    lines: int = 4
    serpentine: bool = False
    every: int = 1
    start: str = "0.0"
    width: str = "0.1"          # of the slow axis
    settings: tuple = ()

    def commands(self):
        stop = Fraction(self.start) + Fraction(self.length)
        return [*self.settings, f"SCANR X={self.start} Y={float(stop)} Z={self.n}", f"SCANV X=0.0 Y={self.width} Z={self.lines}",
                f"SPEED X={self.speed}", f"SCAN F={int(self.serpentine)}", "TTL X=1", "SCAN"]

    def pixels(self):
        return floor(Fraction(self.length) * COUNTS_PER_MM / Fraction(self.n))

    def step_q32(self):
        return floor(Fraction(self.speed) * COUNTS_PER_MM / 10_000 * 2**32 + Fraction(1, 2))

    def edges(self, line):
        """Edges from SYNC on at which the pixels of a line come; those of a return line are the forward line's."""
        n, pixels = Fraction(self.n), self.pixels()
        forward = [ceil(k * n) for k in range(pixels + 1)]
        return [forward[-1] - e for e in reversed(forward)] if self.serpentine and line % 2 else forward


def exact(field, line, sync, pulses):
    """The exact times of SYNC and pulses, with the one phase that fits them all; None if none does."""
    v, ways = field.step_q32(), [e * 2**32 * TICK_CLOCKS for e in field.edges(line)]
    times = [t - LATENCY_CLOCKS for t in (sync, *pulses)]
    # times[k] is the first whole number at or after (phase + ways[k]) / v.
    least = max(v * (t - 1) - way for t, way in zip(times, ways)) + 1
    most = min(v * t - way for t, way in zip(times, ways))
    if least > most:
        return None
    return [-(-(most + way) // v) + LATENCY_CLOCKS for way in ways]


def run(field, timeout_s=None):
    """What tb/twin/scans.cpp prints: (lines, {number: pulses}, errors, stray, simulated_s, processor_s)."""
    program = build("twin/scans")
    done = subprocess.run([program, plant.render(plant.load()), str(field.every), *field.commands()], text=True,
                          capture_output=True, timeout=timeout_s, cwd=toolchain.ROOT)
    assert done.returncode == 0, done.stderr
    lines, pulses, errors = [], {}, []
    for row in done.stdout.splitlines():
        word, *numbers = row.split()
        if word == "line":
            lines.append(tuple(map(int, numbers)))
        elif word == "pulses":
            pulses[len(lines) - 1] = list(map(int, numbers))
        elif word == "error":
            errors.append(int(numbers[0]))
        elif word == "stray":
            stray = int(numbers[0])
        elif word == "time":
            simulated_s, processor_s = map(float, numbers)
    return lines, pulses, errors, stray, simulated_s, processor_s
