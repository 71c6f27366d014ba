# SPDX-License-Identifier: BSD-2-Clause
"""What an encoder does to its wires, and what a decoder that samples them must make of it.

Times are integer picoseconds, on no grid.  The reference knows no clock domain and no pipeline: it looks
up the sampled levels in a list of the four places on the quadrature circle, and finds filtered levels in the
list of all samples.  Expectations are per sample; how many clocks later a block shows them is the block's
business.
"""

import bisect
from dataclasses import dataclass

CIRCLE = ["00", "10", "11", "01"]
"""Levels of A and B, in the order met going up: A leads."""


@dataclass
class Expected:
    """What is known with one sample."""
    count: int
    moved: bool
    up: bool
    a: int
    error: bool
    errors: int
    index: bool
    index_count: int


class Wire:
    """Level of one wire over time."""

    def __init__(self, level=0):
        self._times, self._levels = [-1 << 62], [level]

    @property
    def events(self):
        """``[(time, level)]`` of all changes."""
        return list(zip(self._times[1:], self._levels[1:]))

    @property
    def level(self):
        """The last level."""
        return self._levels[-1]

    def toggle(self, time_ps):
        """Change the level at a time later than all before."""
        assert time_ps > self._times[-1], "changes of a wire are in order of time"
        self._times.append(time_ps)
        self._levels.append(1 - self._levels[-1])

    def at(self, time_ps):
        """The level just before a time."""
        return self._levels[bisect.bisect_left(self._times, time_ps) - 1]


class Encoder:
    """The wires A, B and Z of an encoder, at a place on the circle."""

    def __init__(self, place=0):
        self.a, self.b, self.z = Wire(int(CIRCLE[place][0])), Wire(int(CIRCLE[place][1])), Wire()
        self.position = 0
        self._place = place

    def step(self, time_ps, direction):
        """Cross one edge upward (``direction`` 1) or downward (-1)."""
        before = CIRCLE[self._place]
        self._place = (self._place + direction) % 4
        wire = self.a if CIRCLE[self._place][0] != before[0] else self.b
        wire.toggle(time_ps)
        self.position += direction

    @property
    def events(self):
        """``[(time, name of the wire, level)]`` in order of time."""
        return sorted((t, name, level) for name in "abz" for t, level in getattr(self, name).events)

    def expected(self, sample_times_ps, *, filter=0, invert=False, settled=0, width=32):
        """A list of :class:`Expected`, one per sampling time.

        ``settled``: so many samples at the start are believed without filter, and make no step.
        """
        levels = [_filtered([wire.at(t) for t in sample_times_ps], filter, settled)
                  for wire in (self.a, self.b, self.z)]
        result, last = [], Expected(0, False, False, 0, False, 0, False, 0)
        for n, (a, b, z) in enumerate(zip(*levels)):
            if n < max(settled, 1):
                last = Expected(0, False, False, a, False, 0, False, 0)
            else:
                before = CIRCLE.index(f"{levels[0][n - 1]}{levels[1][n - 1]}")
                travel = (CIRCLE.index(f"{a}{b}") - before) % 4
                change = {0: 0, 1: 1, 2: 0, 3: -1}[travel] * (-1 if invert else 1)
                count = (last.count + change + (1 << width - 1)) % (1 << width) - (1 << width - 1)
                index = z == 1 and levels[2][n - 1] == 0
                last = Expected(
                    count=count, moved=change != 0, up=change > 0, a=a, error=travel == 2,
                    errors=min(last.errors + (travel == 2), 65535), index=index,
                    index_count=count if index else last.index_count)
            result.append(last)
        return result


def _filtered(samples, needed, settled):
    """Each sample replaced by the level last seen ``needed + 1`` times in a row."""
    result = []
    for n, sample in enumerate(samples):
        window = samples[max(0, n - needed):n + 1]
        if n < max(settled, 1) or (len(window) == needed + 1 and len(set(window)) == 1):
            result.append(sample)
        else:
            result.append(result[-1])
    return result
