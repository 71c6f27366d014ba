# SPDX-License-Identifier: BSD-2-Clause
"""A and B to a count: four counts per period, up when A leads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .capture import Trace

# Place of a level pair in the order it passes through when the count rises, indexed 2*A + B.
PLACE = np.array([0, 3, 1, 2], dtype=np.int8)


@dataclass(frozen=True)
class Count:
    """Every encoder edge.

    Members
    -------
    times_ps : int64 array
        When each edge was.
    steps : int8 array
        +1 or -1, and 0 for an illegal edge: both channels changed at one time, so counts were lost.
    counts : int64 array
        The count after each edge; it starts from ``origin_counts``.
    """

    times_ps: np.ndarray
    steps: np.ndarray
    counts: np.ndarray
    origin_counts: int = 0

    def illegal_ps(self) -> np.ndarray:
        """Times of the illegal edges."""
        return self.times_ps[self.steps == 0]

    def at(self, time_ps: int) -> int:
        """The count just after ``time_ps``."""
        passed = int(np.searchsorted(self.times_ps, time_ps, side="right"))
        return int(self.counts[passed - 1]) if passed else self.origin_counts


def decode(a: Trace, b: Trace, origin_counts: int = 0) -> Count:
    """Rebuild the count. ``origin_counts`` is the count at the start of the file, which A and B cannot tell."""
    times_ps = np.union1d(a.toggles_ps, b.toggles_ps)
    level_a = (a.initial + np.searchsorted(a.toggles_ps, times_ps, side="right")) & 1
    level_b = (b.initial + np.searchsorted(b.toggles_ps, times_ps, side="right")) & 1
    place = np.append(PLACE[2 * a.initial + b.initial], PLACE[2 * level_a + level_b])
    turn = np.diff(place) & 3                                # 1 up, 3 down, 2 both channels
    steps = np.where(turn == 1, 1, np.where(turn == 3, -1, 0)).astype(np.int8)
    return Count(times_ps, steps, origin_counts + np.cumsum(steps, dtype=np.int64), origin_counts)
