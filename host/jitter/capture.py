# SPDX-License-Identifier: BSD-2-Clause
"""A capture: digital channels as lists of toggle times, in picoseconds."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


class CaptureError(Exception):
    """The file cannot be measured; the message says what was expected and what came."""


@dataclass(frozen=True)
class Trace:
    """One digital channel.

    Members
    -------
    initial : int
        Level (0 or 1) before the first toggle.
    toggles_ps : int64 array
        Strictly rising times at which the level changes.
    """

    initial: int
    toggles_ps: np.ndarray

    @classmethod
    def from_changes(cls, times_ps, levels) -> Trace:
        """Build from value changes in time order; repeated levels are dropped.

        Several changes at one time count as the last of them: a pulse of no width is no pulse.
        """
        times_ps = np.asarray(times_ps, dtype=np.int64)
        levels = np.asarray(levels, dtype=np.int8)
        if times_ps.size == 0:
            return cls(0, times_ps)
        last = np.append(np.diff(times_ps) != 0, True)
        times_ps, levels = times_ps[last], levels[last]
        changed = np.append(False, np.diff(levels) != 0)
        return cls(int(levels[0]), times_ps[changed])

    def inverted(self) -> Trace:
        """The same channel with its levels exchanged."""
        return Trace(1 - self.initial, self.toggles_ps)

    def rising_ps(self) -> np.ndarray:
        """Times of the changes from 0 to 1."""
        return self.toggles_ps[self.initial::2]

    def falling_ps(self) -> np.ndarray:
        """Times of the changes from 1 to 0."""
        return self.toggles_ps[1 - self.initial::2]

    def level_at(self, time_ps: int) -> int:
        """Level just after ``time_ps``."""
        passed = int(np.searchsorted(self.toggles_ps, time_ps, side="right"))
        return (self.initial + passed) & 1


@dataclass(frozen=True)
class Capture:
    """What a file held.

    Members
    -------
    traces : dict
        Channel name to :class:`Trace`.
    end_ps : int
        Time at which the recording stops.
    cut_short : bool
        The last line of the file was not complete and has been left out.
    notes : list of str
        What the reader had to assume.
    """

    traces: dict[str, Trace]
    end_ps: int
    cut_short: bool = False
    notes: list[str] = field(default_factory=list)

    def resolution_ps(self) -> int:
        """The step all times are multiples of: how finely the file knows when an edge was.

        A logic analyser at 100 MS/s gives 10 000, whatever unit its file is written in.
        """
        step = 0
        for trace in self.traces.values():
            if trace.toggles_ps.size:
                step = int(np.gcd(step, np.gcd.reduce(trace.toggles_ps)))
        return max(step, 1)


def choose(names: list[str], wanted: str) -> str:
    """The one of ``names`` meant by ``wanted``: the full name, or its last part where that is unique.

    Raises :exc:`CaptureError` naming what there is when none or several fit.
    """
    if wanted in names:
        return wanted
    fitting = [name for name in names if name.rsplit(".", 1)[-1] == wanted]
    if len(fitting) == 1:
        return fitting[0]
    shown = ", ".join(names[:40]) + (", ..." if len(names) > 40 else "")
    if fitting:
        raise CaptureError(f"channel {wanted!r} is ambiguous: {', '.join(fitting)}")
    raise CaptureError(f"no channel {wanted!r}; the file has: {shown or 'no channels'}")
