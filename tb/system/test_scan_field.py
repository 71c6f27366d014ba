# SPDX-License-Identifier: BSD-2-Clause
"""A field of 0.1 mm by 0.1 mm, raster and serpentine, on the real firmware in the real gateware: every line's pulse train.

Pins alone are looked at. Encoder edges are recorded at their true times; the model is the definition: the line begins with
the edge that makes its start count (forward), pixel k comes with the edge ceil(k N) further on, for the first time, and a
return line begins at the last of these edges and takes the same ones in reverse order. A pulse rises at the 10th clock
after the one that samples its edge: 50 to 55 ns after the edge. SYNC rises so after the first and falls with the last.

189 lines of 189 pixels in ``make test-slow`` (``FULL_LINES=1``), three of them in the ordinary suite.
"""

import os
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

import numpy as np
import pytest

from tb.sim.simulator import MS, SIGNALS

COUNTS_PER_MM = 45396
CLOCK_PS, LATENCY_CLOCKS = 5_000, 10
FULL = "FULL_LINES" in os.environ
LINES = 189 if FULL else 3
FIELD_MM = "0.1"
TIME_LIMIT_PS = LINES * 400 * MS

SIGNAL = {name: SIGNALS.index(name) for name in ("x_a", "x_b", "y_a", "y_b", "sync", "encoder")}
PLACES = {(0, 0): 0, (1, 0): 1, (1, 1): 2, (0, 1): 3}       # A leads B when the count rises


@dataclass
class Line:
    """What the pins showed while SYNC was high; times in ps."""
    rise: int
    fall: int
    steps: list                     # (time, edge crossed, +1 or -1), from before the rise on
    pulses: list


class Watch:
    """Takes the record apart into lines as it comes."""

    def __init__(self, sim):
        self._sim, self.lines, self.stray, self._steps, self._pulses = sim, [], 0, [], []
        levels = sim.levels()
        self._ab = [levels["x_a"], levels["x_b"]]
        self._y = [levels["y_a"], levels["y_b"]]
        self._count, self._rise, self.y_moved_in_line = 0, None, 0
        sim.record(*SIGNAL)

    def take(self):
        names = {n: name for name, n in SIGNAL.items()}
        changes = self._sim.changes()
        for time, signal, level in zip(changes["time_ps"].tolist(), changes["signal"].tolist(), changes["level"].tolist()):
            name = names[signal]
            if name in ("x_a", "x_b"):
                before = PLACES[tuple(self._ab)]
                self._ab[name == "x_b"] = level
                step = 1 if (PLACES[tuple(self._ab)] - before) % 4 == 1 else -1
                self._count += step
                self._steps.append((time, self._count if step > 0 else self._count + 1, step))
            elif name in ("y_a", "y_b"):
                self.y_moved_in_line += self._rise is not None
            elif name == "encoder" and level:
                # The last pulse rises as SYNC falls, and may be told of after it.
                if self._rise is not None:
                    self._pulses.append(time)
                elif self.lines and time == self.lines[-1].fall:
                    self.lines[-1].pulses.append(time)
                else:
                    self.stray += 1
            elif name == "sync" and level:
                self._rise, self._pulses, self._steps = time, [], self._steps[-4:]
            elif name == "sync":
                self.lines.append(Line(self._rise, time, self._steps, self._pulses))
                self._rise, self._steps = None, []
            if self._rise is None and len(self._steps) > 64:
                self._steps = self._steps[-8:]


def expected(n, pixels, number, serpentine):
    """(reference edge, direction, edges of the pixels) of a line that starts at count 0."""
    forward = [ceil(k * Fraction(n)) for k in range(pixels + 1)]
    if serpentine and number % 2:
        return forward[-1], -1, forward[-2::-1]
    return 0, 1, forward[1:]


def check(line, reference, direction, edges):
    """None, or what is wrong with a line."""
    def after(time, edge_time):
        return LATENCY_CLOCKS * CLOCK_PS <= time - edge_time <= (LATENCY_CLOCKS + 1) * CLOCK_PS

    starts = [t for t, edge, step in line.steps if edge == reference and step == direction and after(line.rise, t)]
    if len(starts) != 1:
        return f"SYNC rose at {line.rise} ps, not with edge {reference}"
    progress, front, times = 0, 0, {}
    for time, edge, step in line.steps:
        if time <= starts[0]:
            continue
        progress += step * direction
        if progress > front:
            front = progress
            times[edge] = time
    wanted = [times.get(edge) for edge in edges]
    if len(line.pulses) != len(wanted):
        return f"{len(line.pulses)} pulses, not {len(wanted)}"
    for k, (pulse, time) in enumerate(zip(line.pulses, wanted), 1):
        if time is None or not after(pulse, time):
            return f"pixel {k} at {pulse} ps, its edge at {time}"
    return None if line.fall == line.pulses[-1] else f"SYNC fell at {line.fall} ps, the last pixel came at {line.pulses[-1]}"


@pytest.mark.parametrize("n, serpentine", [("24", False), ("24", True)] + [("24.4", True)] * (not FULL))
def test_every_line_of_a_field_is_exact(powered, n, serpentine):
    pixels = floor(Fraction(FIELD_MM) * COUNTS_PER_MM / Fraction(n))
    width = Fraction(FIELD_MM) * LINES / 189
    for line in (f"SCANR X=0 Y={FIELD_MM} Z={n}", f"SCANV X=0 Y={float(width):.6f} Z={LINES} F=2",
                 "SPEED X=5 Y=5", "AC X=10 Y=10", f"SCAN F={int(serpentine)}", "TTL X=1"):
        assert powered.command(line) == ":A \r\n"
    watch = Watch(powered)
    assert powered.command("SCAN") == ":A \r\n"
    end_ps = powered.time_ps + TIME_LIMIT_PS
    while powered.command("/") == "B\r\n":
        assert powered.time_ps < end_ps, f"busy after {len(watch.lines)} lines"
        powered.run(10 * MS)
        watch.take()
    watch.take()
    assert len(watch.lines) == LINES and watch.stray == 0
    wrong = {number: check(line, *expected(n, pixels, number, serpentine)) for number, line in enumerate(watch.lines)}
    assert not {number: what for number, what in wrong.items() if what}
    assert watch.y_moved_in_line == 0, "the slow axis moved in a line"
    phases = np.array([t % CLOCK_PS for line in watch.lines for t in (line.rise, line.fall, *line.pulses)])
    assert len(set(phases)) == 1, "not all at one phase of the clock"
    # A moved pulse, a missing one and a late SYNC would be seen.
    line = watch.lines[0]
    args = expected(n, pixels, 0, serpentine)
    assert check(Line(line.rise, line.fall, line.steps, line.pulses[:50] + line.pulses[51:]), *args)
    assert check(Line(line.rise, line.fall, line.steps, [t + CLOCK_PS * 2 * (k == 7) for k, t in
                                                         enumerate(line.pulses)]), *args)
    assert check(Line(line.rise + 2 * CLOCK_PS, line.fall, line.steps, line.pulses), *args)
    print(f"{'serpentine' if serpentine else 'raster'}, N = {n}: {LINES} lines of {pixels} pixels, each pulse at its edge, "
          f"{powered.time_ps / MS / 1000:.1f} s of scan")
