# SPDX-License-Identifier: BSD-2-Clause
"""Whole scans on the virtual controller, far faster than in real time, and every pulse of sampled lines by arithmetic.

The firmware and the model of the gateware are those of ``make twin``; the stage is one that does what it is told
(tb/twin/follower.h). So a line is a straight line in time, known but for its phase, and the exact model of its pulses is a
rounded-up quotient: encoder edge e is sampled at the first clock of ``fast`` at or after ``a + e * 2^32 * 20000 / v``, v the
set-point's step in 2^-32 counts a servo tick of 20000 clocks, and shows at the pins 10 clocks later.  The phase a must be
the same for SYNC and every pixel of the line.

``make test-slow`` (``FULL_LINES=1``) scans the whole field of the original's manual, 1891 lines of 1891 pixels.
"""

import hashlib
import os
import subprocess
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

import pytest

from tb import toolchain
from tb.board import plant
from tb.firmware.host import build

COUNTS_PER_MM = 45396
TICK_CLOCKS = 20_000
LATENCY_CLOCKS = 10
FULL = "FULL_LINES" in os.environ


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

    def commands(self):
        stop = Fraction(self.start) + Fraction(self.length)
        return [f"SCANR X={self.start} Y={float(stop)} Z={self.n}", f"SCANV X=0.0 Y={self.width} Z={self.lines}",
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


def hash_of(times):
    return hashlib.sha256(b"".join(t.to_bytes(8, "little") for t in times)).hexdigest()


def run(field):
    """What tb/twin/scans.cpp prints: (lines, {number: pulses}, errors, stray, simulated_s, processor_s)."""
    program = build("twin/scans")
    done = subprocess.run([program, plant.render(plant.load()), str(field.every), *field.commands()], text=True,
                          capture_output=True, timeout=None if FULL else 120, cwd=toolchain.ROOT)
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


def judge(field):
    lines, sampled, errors, stray, simulated_s, processor_s = run(field)
    assert errors == [] and stray == 0
    assert len(lines) == field.lines
    assert {pulses for _, _, pulses, _, _ in lines} == {field.pixels()}
    # SYNC falls with the last pixel; a line lasts as long as its way at its speed, to a clock.
    way = field.edges(0)[-1] * 2**32 * TICK_CLOCKS / field.step_q32()
    assert all(end == last and abs(end - sync - way) <= 1 for sync, end, _, _, last in lines)
    assert all(a[1] < b[0] for a, b in zip(lines, lines[1:]))
    for number, pulses in sampled.items():
        sync = lines[number][0]
        times = exact(field, number, sync, pulses)
        assert times is not None, f"line {number}: no phase fits"
        assert hash_of(times) == hash_of([sync, *pulses]), f"line {number}"
    print(f"{field.lines} lines of {field.pixels()} pixels, {len(sampled)} of them pulse by pulse: {simulated_s:.1f} s "
          f"in {processor_s:.2f} s of a processor, {simulated_s / processor_s:.0f} times real time")
    return sampled


FIELDS = {
    "raster": Field(),
    "serpentine": Field(serpentine=True),
    "serpentine, N = 24.4": Field(serpentine=True, n="24.4"),
    "serpentine, N = 38, faster": Field(serpentine=True, n="38", speed="2.5"),
    "raster, from a negative start": Field(start="-0.5", lines=3),
    "N = 1": Field(n="1", length="0.05", speed="0.1"),
}


@pytest.mark.parametrize("name", FIELDS)
def test_every_pulse_of_a_scan_is_the_exact_one(name):
    assert len(judge(FIELDS[name])) == FIELDS[name].lines


@pytest.mark.parametrize("serpentine", [False, True])
def test_the_field_of_the_manual(serpentine):
    """1891 lines and 20 of them pulse by pulse; in the ordinary suite its first 40 lines and all of them."""
    field = Field(lines=1891, width="1.0", serpentine=serpentine, every=95) if FULL else \
        Field(lines=40, width=f"{40 / 1891:.6f}", serpentine=serpentine)
    assert field.pixels() == 1891
    assert len(judge(field)) == (20 if FULL else 40)


def test_a_pulse_that_is_a_clock_late_is_seen():
    field = Field(lines=1)
    lines, sampled, *_ = run(field)
    pulses = sampled[0]
    assert exact(field, 0, lines[0][0], pulses) is not None
    moved = [t + (k == 1000) for k, t in enumerate(pulses)]
    # Within the freedom of the phase, a few clocks in a million, one clock cannot hide.
    found = exact(field, 0, lines[0][0], moved)
    assert found is None or hash_of(found) != hash_of([lines[0][0], *moved])
