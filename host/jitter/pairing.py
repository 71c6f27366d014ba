# SPDX-License-Identifier: BSD-2-Clause
"""SYNC pulses to lines, and the pulses of a line to pixels by index.

Every SYNC pulse is a line. SYNC leaves the chip a latency after its own encoder edge, so that edge is the
last one in the scan direction before SYNC within the greatest latency. Where no greatest latency is stated,
a pulse may come until half-way to the next one, and SYNC a pixel or 50 us late, whichever is less. Progress is the number
of new maxima in the scan direction since that edge; going back and returning is no progress. Pixel k
belongs to the edge at which progress reaches floor(k*N + phi), and to no other: a pulse is pixel k when
that edge lies before it by the stated latency, whatever other pulses there are. So a missing pulse
leaves one k without a pulse, an added one leaves one pulse without a k, and nothing shifts.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .count import Count
from .divide import Divide

LEAST_WINDOW_PS = 1_000_000                                  # pixels may follow each other faster than the latency
SYNC_WINDOW_PS = 50_000_000


@dataclass
class Line:
    """One SYNC pulse and its pixels. Times in ps, counts as the decoder has them.

    Members
    -------
    sync_ps, end_ps : int
        SYNC's active and inactive edge; ``end_ps`` is the end of the file where ``complete`` is False.
    direction : int
        +1 or -1.
    reference_ps : int or None
        SYNC's own encoder edge; None when there is none within the latency, and then nothing is paired.
    sync_window_ps, window_ps : (int, int)
        Least and greatest latency looked for: of SYNC, and of pixel pulses.
    start_counts, end_counts : int
        The count at the reference edge, and at the last pixel's edge.
    edge_ps : int64 array
        Completing edge of pixels 1, 2, ... as far as the stage went.
    expected : int
        Pixels the line should have.
    unrecorded : int
        Pixels asked for that lie beyond the end of the file; they count as neither expected nor missed.
    k, pulse_ps, latency_ps : int64 arrays
        The pixels that have their pulse.
    missed : int64 array
        Expected k without a pulse.
    merged : int64 array
        Those of ``missed`` that fell due while the pulse before was still high.
    extra_ps : int64 array
        Pulses that are no pixel.
    """

    sync_ps: int
    end_ps: int
    complete: bool
    direction: int
    reference_ps: int | None = None
    sync_window_ps: tuple[int, int] = (0, LEAST_WINDOW_PS)
    window_ps: tuple[int, int] = (0, LEAST_WINDOW_PS)
    start_counts: int = 0
    end_counts: int = 0
    expected: int = 0
    unrecorded: int = 0
    edge_ps: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))
    k: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))
    pulse_ps: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))
    latency_ps: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))
    missed: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))
    merged: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))
    extra_ps: np.ndarray = field(default_factory=lambda: np.empty(0, np.int64))

    def sync_latency_ps(self) -> int | None:
        """From SYNC's own encoder edge to SYNC."""
        return None if self.reference_ps is None else self.sync_ps - self.reference_ps


def find_lines(count: Count, sync, capture_end_ps: int) -> list[Line]:
    """A :class:`Line` for every rising edge of ``sync``, with no reference and no pixels yet."""
    falling = sync.falling_ps()
    lines = []
    for sync_ps in sync.rising_ps().tolist():
        after = int(np.searchsorted(falling, sync_ps, side="right"))
        complete = after < len(falling)
        end_ps = int(falling[after]) if complete else capture_end_ps
        lines.append(Line(sync_ps, end_ps, complete, int(np.sign(count.at(end_ps) - count.at(sync_ps)))))
    return lines


def find_references(lines: list[Line], count: Count, divide: Divide, latency_ps: tuple[int, int | None],
                    earlier: int = 0):
    """Settle how late the pulses of each line may be, and find SYNC's own edge.

    ``latency_ps`` is the least and greatest latency; None for the greatest takes it from the line's speed.
    ``earlier`` takes the edge so many before the last one.
    """
    for line in lines:
        least_ps, greatest_ps = latency_ps
        line.window_ps = line.sync_window_ps = (least_ps, greatest_ps)
        if greatest_ps is None:
            counts = abs(count.at(line.end_ps) - count.at(line.sync_ps))
            pixel_ps = int((line.end_ps - line.sync_ps) * divide.value() / counts) if counts else 0
            line.window_ps = (least_ps, max(least_ps + LEAST_WINDOW_PS, pixel_ps // 2))
            line.sync_window_ps = (least_ps, max(least_ps + LEAST_WINDOW_PS, min(pixel_ps, SYNC_WINDOW_PS)))
        least_ps, greatest_ps = line.sync_window_ps
        first = int(np.searchsorted(count.times_ps, line.sync_ps - greatest_ps))
        last = int(np.searchsorted(count.times_ps, line.sync_ps - least_ps, side="right"))
        if line.direction == 0:                              # a line without motion: the way it came
            line.direction = int(count.steps[last - 1]) if last else 1
        candidates = np.flatnonzero(count.steps[first:last] == line.direction)
        if candidates.size > earlier:
            edge = int(first + candidates[-1 - earlier])
            line.reference_ps = int(count.times_ps[edge])
            line.start_counts = line.end_counts = int(count.counts[edge])


def pair(lines: list[Line], count: Count, pixel, divide: Divide, pixels: int | None,
         serpentine: bool = False) -> np.ndarray:
    """Give the pulses of ``pixel`` to the pixels of ``lines``; return the pulses outside any line.

    ``pixels`` is what a line
    should have; None means as many as the stage completed while SYNC was active. ``serpentine``: lines against
    the first one's direction have their pixels on the first one's edges.
    """
    rising, falling = pixel.rising_ps(), pixel.falling_ps()
    in_a_line = np.zeros(len(rising), dtype=bool)
    for i, line in enumerate(lines):
        next_ps = lines[i + 1].sync_ps if i + 1 < len(lines) else np.iinfo(np.int64).max
        # The last pixel's pulse leaves with the end of SYNC or a latency after it.
        mine = (rising >= line.sync_ps) & (rising <= min(line.end_ps + line.window_ps[1], next_ps - 1))
        in_a_line |= mine
        if line.reference_ps is None:
            line.extra_ps = rising[mine]
            continue
        back = serpentine and line.direction != lines[0].direction
        own = divide.returning(pixels or lines[0].expected) if back else divide
        _complete(line, count, own, line.window_ps, pixels, next_ps)
        _assign(line, rising[mine], line.window_ps)
        # What comes after SYNC and is no pixel of the line is outside it.
        in_a_line[np.isin(rising, line.extra_ps[line.extra_ps > line.end_ps + LEAST_WINDOW_PS])] = False
        line.extra_ps = line.extra_ps[line.extra_ps <= line.end_ps + LEAST_WINDOW_PS]
        if not line.complete:
            _leave_out_the_unrecorded(line, line.window_ps, pixels)
        _find_merged(line, rising, falling)
    return rising[~in_a_line]


def _complete(line, count, divide, window_ps, pixels, next_ps):
    """Find the completing edges, and how many pixels the line should have."""
    first, last = np.searchsorted(count.times_ps, [line.reference_ps, next_ps], side="right")
    progress = line.direction * (count.counts[first:last] - line.start_counts)
    highest = np.maximum.accumulate(np.append(0, progress))
    new_maximum_ps = count.times_ps[first:last][np.diff(highest) > 0]
    reached = divide.pixels_within(len(new_maximum_ps))
    line.edge_ps = new_maximum_ps[divide.progress(reached) - 1]
    if pixels is None:
        line.expected = int(np.searchsorted(line.edge_ps, line.end_ps - window_ps[0], side="right"))
    else:
        line.expected = pixels
    last_pixel = min(line.expected, reached)
    if last_pixel:
        line.end_counts = line.start_counts + line.direction * int(divide.progress(last_pixel)[-1])


def _assign(line, pulses_ps, window_ps):
    """Each pulse to the k whose edge it follows by the latency; at most one pulse to a k."""
    edges = line.edge_ps[:line.expected]
    first = np.searchsorted(edges, pulses_ps - window_ps[1], side="left")
    last = np.searchsorted(edges, pulses_ps - window_ps[0], side="right")
    clear = last - first == 1
    # Where pixels follow each other faster than the window is wide, several edges are possible: then
    # the latency of the clear ones decides, or SYNC's, being one constant for all.
    usual = (int(np.median((pulses_ps - edges[first.clip(max=max(len(edges) - 1, 0))])[clear]))
             if clear.any() else line.sync_latency_ps())
    chosen: dict[int, int] = {}
    extra = []
    for pulse, low, high in zip(pulses_ps.tolist(), first.tolist(), last.tolist()):
        if low == high:
            extra.append(pulse)
            continue
        k = low + int(np.argmin(np.abs(pulse - edges[low:high] - usual))) if high - low > 1 else low
        other = chosen.get(k)
        if other is None:
            chosen[k] = pulse
        elif abs(pulse - edges[k] - usual) < abs(other - edges[k] - usual):
            chosen[k] = pulse
            extra.append(other)
        else:
            extra.append(pulse)
    index = np.array(sorted(chosen), dtype=np.int64)
    line.k = index + 1
    line.pulse_ps = np.array([chosen[i] for i in index.tolist()], dtype=np.int64)
    line.latency_ps = line.pulse_ps - edges[index] if len(index) else index
    line.missed = np.setdiff1d(np.arange(1, line.expected + 1), line.k)
    line.extra_ps = np.array(sorted(extra), dtype=np.int64)


def _leave_out_the_unrecorded(line, window_ps, pixels):
    """Where the file ends in the line, pixels whose pulse would lie beyond its end are not missed."""
    recorded = int(np.searchsorted(line.edge_ps, line.end_ps - window_ps[1], side="right"))
    beyond = line.missed > recorded
    line.unrecorded = int(beyond.sum()) if pixels is not None else 0
    line.expected -= int(beyond.sum())
    line.missed = line.missed[~beyond]


def _find_merged(line, rising, falling):
    """A missed pixel is merged when the output was still high when its pulse was due."""
    due = line.missed[line.missed <= len(line.edge_ps)]
    if not (due.size and line.latency_ps.size):
        return
    due_ps = line.edge_ps[due - 1] + int(np.median(line.latency_ps))
    high = np.searchsorted(rising, due_ps, side="left") > np.searchsorted(falling, due_ps, side="left")
    line.merged = due[high]
