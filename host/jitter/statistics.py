# SPDX-License-Identifier: BSD-2-Clause
"""What the lines of a capture amount to: the figures, and everything that is wrong, said in words."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .capture import Capture, CaptureError
from .count import Count, decode
from .divide import Divide
from .pairing import Line, find_lines, find_references, pair

EARLIER_EDGES = 8                                            # looked through for SYNC's own
PHASE_BINS = 10
PHASE_BIN_PERCENT = (5.0, 15.0)


@dataclass(frozen=True)
class Settings:
    """What to look for.

    Members
    -------
    divide : Divide or None
        N; None takes it from the data: the median number of counts from pulse to pulse.
    pixels : int or None
        Pixels in every line; None expects as many as the stage completed while SYNC was active.
    clock_ps : float
        Period of the clock that samples the encoder.
    latency_ps : (int, int or None)
        Least and greatest latency from an encoder edge to its pulse; None takes the greatest from the line's
        speed (:mod:`host.jitter.pairing`).
    counts_per_mm : float or None
        For distances in the text and the picture.
    origin_counts : int
        The count at the start of the file.
    serpentine : bool
        Return lines have their pixels on the edges of the forward ones.
    """

    divide: Divide | None = None
    pixels: int | None = None
    clock_ps: float = 5000
    latency_ps: tuple[int, int | None] = (0, None)
    counts_per_mm: float | None = None
    origin_counts: int = 0
    serpentine: bool = False


@dataclass(frozen=True)
class Grid:
    """The clock as its outputs show it.

    Members
    -------
    phase_ps : float or None
        Where in a clock period the outputs change; None when they do not keep to one place, as when an
        analyser with its own clock recorded them.
    tolerance_ps : int
        How finely the file tells a time.
    """

    clock_ps: float
    phase_ps: float | None
    tolerance_ps: int

    def clocks_since_sampling(self, edge_ps, pulse_ps):
        """Clocks from the one that samples an edge to the pulse: the fewest and most it can have been.

        They differ for an edge within the tolerance of a clock, which either may have sampled.
        """
        edge, pulse = np.asarray(edge_ps) - self.phase_ps, np.asarray(pulse_ps) - self.phase_ps
        early = np.ceil((edge - self.tolerance_ps) / self.clock_ps)
        late = np.ceil((edge + self.tolerance_ps) / self.clock_ps)
        return pulse / self.clock_ps - late, pulse / self.clock_ps - early


@dataclass
class Figures:
    """The result. ``pulses`` is how many pixel pulses the file has; ``report.as_dict`` names the rest."""

    settings: Settings
    divide: Divide
    divide_source: str
    count: Count
    lines: list[Line]
    pulses: int
    grid: Grid
    outside_ps: np.ndarray
    widths_ps: np.ndarray
    short_ps: np.ndarray
    latency_clocks: int | None = None
    moved: list[dict] = field(default_factory=list)
    phase_percent: np.ndarray | None = None
    findings: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def latency_ps(self) -> np.ndarray:
        """Of every paired pulse of every line."""
        return np.concatenate([line.latency_ps for line in self.lines] or [np.empty(0, np.int64)])

    def period_jitter_clocks(self) -> np.ndarray:
        """Each pulse-to-pulse period less that of its edges, where both neighbours have their pulse."""
        parts = [np.diff(line.latency_ps)[np.diff(line.k) == 1] for line in self.lines]
        return np.concatenate(parts or [np.empty(0)]) / self.settings.clock_ps

    def missed(self) -> int:
        return sum(len(line.missed) for line in self.lines)

    def extra(self) -> int:
        return sum(len(line.extra_ps) for line in self.lines) + len(self.outside_ps)

    def jitter_limit_ps(self) -> float:
        """The most that sampling can make of a constant latency, as this file can show it."""
        return self.settings.clock_ps + 2 * self.grid.tolerance_ps


def measure(capture: Capture, a: str, b: str, sync: str, pixel: str, settings: Settings) -> Figures:
    """Measure the channels with these names. Raises :exc:`CaptureError` when N cannot be known."""
    traces = capture.traces
    count = decode(traces[a], traces[b], settings.origin_counts)
    pulses = traces[pixel]
    lines = find_lines(count, traces[sync], capture.end_ps)
    divide, source = settings.divide, "given"
    idle = _idle_axis(count, lines, pulses, a, b)
    if divide is None and idle:
        raise CaptureError(idle)
    if divide is None:
        divide, source = _divide_from_data(count, lines, pulses), "median of the counts from pulse to pulse"
    lines, outside, earlier = _pair(capture, count, traces[sync], pulses, divide, settings)
    grid = _find_grid(settings.clock_ps, capture.resolution_ps(), traces[sync], pulses)
    widths = _widths(pulses)
    figures = Figures(settings, divide, source, count, lines, len(pulses.rising_ps()), grid, outside, widths,
                      np.empty(0, np.int64))
    figures.notes += capture.notes
    if settings.divide is None:
        figures.notes.append(f"N = {divide.whole} is taken from the data; one with a fraction must be given")
    if earlier:
        figures.notes.append(f"SYNC is taken to be {earlier + 1} edges late: with a nearer edge pulses come too early")
    if capture.cut_short:
        figures.notes.append("the last line of the file is not complete and was left out")
    _find_moved(figures)
    figures.short_ps = _short(pulses, figures)
    _bin_phases(figures)
    if idle:
        figures.findings.append(idle)
    else:
        _doubt_divide(figures, pulses)
        _say(figures)
    return figures


def _pair(capture, count, sync, pulses, divide, settings):
    """Lines with their pixels, the pulses outside, and how many edges before the last one SYNC's own is taken.

    SYNC's own edge is the last one, unless no greatest latency is given, the latency is not constant, and an earlier
    edge leaves at most half as many pixels and pulses without each other: a program may take longer than an edge.
    """
    limit = settings.clock_ps + 2 * capture.resolution_ps()
    best = None
    for earlier in range(1 + (EARLIER_EDGES if settings.latency_ps[1] is None else 0)):
        lines = find_lines(count, sync, capture.end_ps)
        find_references(lines, count, divide, settings.latency_ps, earlier)
        outside = pair(lines, count, pulses, divide, settings.pixels, settings.serpentine)
        wrong = len(outside) + sum(len(line.missed) + len(line.extra_ps) for line in lines)
        if best is None or 2 * wrong <= best[0]:
            best = wrong, lines, outside, earlier
        latency = np.concatenate([line.latency_ps for line in lines] or [np.empty(0)])
        constant = latency.size and 2 * _held(latency, limit)[0].max() >= len(latency)
        if not best[0] or constant or any(line.reference_ps is None for line in lines):
            break
    return best[1:]


def _idle_axis(count, lines, pulses, a, b):
    """What to say where there are more pulses in the lines than encoder edges, which no divide makes; or None."""
    rising = pulses.rising_ps()
    spans = [(line.sync_ps, line.end_ps) for line in lines]
    made, edges = (sum(int(np.diff(np.searchsorted(times, span))[0]) for span in spans)
                   for times in (rising, count.times_ps))
    if made < 2 or edges >= made:
        return None
    return (f"{a} and {b} hardly change while {made} pulses come ({edges} edges): is this the scanned axis "
            "(--axis, --a, --b)?")


def _counts_between_pulses(count, lines, pulses):
    """Counts from each pulse of a line to the next one."""
    gaps = [np.empty(0)]
    rising = pulses.rising_ps()
    for line in lines:
        mine = rising[(rising >= line.sync_ps) & (rising <= line.end_ps)]
        at = np.searchsorted(count.times_ps, mine, side="right") - 1
        gaps.append(np.abs(np.diff(count.counts[at[at >= 0]])))
    return np.concatenate(gaps)


def _divide_from_data(count, lines, pulses):
    """Median counts between neighbouring pulses of a line; a missing pulse or two does not change it."""
    gaps = _counts_between_pulses(count, lines, pulses)
    if not lines:
        raise CaptureError("no SYNC edge in the file: is this the line's SYNC (--sync)?")
    if not gaps.size or np.median(gaps) < 1:
        raise CaptureError("N is not given and the file has no line with two pulses to take it from")
    return Divide(int(np.median(gaps)))


def _doubt_divide(figures, pulses):
    """Where pulses and pixels do not match and the pulses keep to another N, say that first."""
    gaps = _counts_between_pulses(figures.count, figures.lines, pulses)
    if not gaps.size or figures.missed() + figures.extra() < 2:
        return
    usual = gaps[np.abs(gaps - np.median(gaps)) <= 1]        # a missing pulse or two does not change it
    # The mean of so many whole gaps is known to about a count over their number.
    known, mean = 2 / len(usual), float(usual.mean())
    if len(usual) < 10 or len(usual) < 0.9 * len(gaps) or abs(mean - figures.divide.value()) <= known:
        return
    if abs(mean - round(mean)) <= known:
        mean = round(mean)
    figures.findings.append(f"the pulses look like N = {mean:.5g}, not {figures.divide.value():.10g} (--n)")


def _find_grid(clock_ps, tolerance_ps, *outputs):
    """Outputs leave flip-flops, so they all change at one phase of the clock, if the file shows it."""
    times = np.concatenate([trace.toggles_ps for trace in outputs])
    if tolerance_ps > clock_ps / (2 * PHASE_BINS) or times.size < 3:
        return Grid(clock_ps, None, tolerance_ps)
    phase = np.mod(times, clock_ps)
    usual, often = np.unique(np.rint(phase), return_counts=True)
    centre = usual[np.argmax(often)]
    distance = np.mod(phase - centre + clock_ps / 2, clock_ps) - clock_ps / 2
    near = np.abs(distance) <= tolerance_ps
    if near.mean() < 0.9:
        return Grid(clock_ps, None, tolerance_ps)
    return Grid(clock_ps, float(centre + np.median(distance[near])), tolerance_ps)


def _widths(pulses):
    """High time of every pulse that ends within the file."""
    rising, falling = pulses.rising_ps(), pulses.falling_ps()
    falling = falling[1:] if falling.size and rising.size and falling[0] < rising[0] else falling
    pairs = min(len(rising), len(falling))
    return falling[:pairs] - rising[:pairs]


def _short(pulses, figures):
    """Rising edges of the pulses narrower than most by more than a clock; made by a program, by half."""
    widths = figures.widths_ps
    if not widths.size:
        return widths
    usual = np.median(widths)
    slack = figures.settings.clock_ps + 2 * figures.grid.tolerance_ps
    if figures.latency_clocks is None and figures.latency_ps().size:
        slack = max(slack, usual / 2)
    return pulses.rising_ps()[:len(widths)][widths < usual - slack]


def _find_moved(figures):
    """Name every pulse whose latency is not the constant one; SYNC is pixel 0.

    Where the clock is known, latency from the sampling clock is a whole number and the commonest is the
    constant. Otherwise latencies may fill a window one clock wide, and the window is where most are.
    Where most pulses have no one latency, as those made by a program, none is called moved: the jitter says it.
    """
    grid, limit = figures.grid, figures.jitter_limit_ps()
    number, k, edge, pulse = _all_pulses(figures.lines)
    if not len(k):
        return
    latency = pulse - edge
    held, ordered = _held(latency, limit)
    low = ordered[np.argmax(held)]
    high = ordered[np.argmax(held) + held.max() - 1]
    varies = bool(figures.latency_ps().size) and np.ptp(figures.latency_ps()) > limit
    if grid.phase_ps is None:
        if varies and 2 * held.max() < len(k):
            return
        figures.latency_clocks = round(float(low) / grid.clock_ps)
        wrong = (latency < low) | (latency > low + limit)
        by = np.where(latency < low, latency - high, latency - low) / grid.clock_ps
    else:
        fewest, most = grid.clocks_since_sampling(edge, pulse)
        values, often = np.unique(np.rint(np.append(fewest, most)), return_counts=True)
        usual = int(values[np.argmax(often)])
        slack = 2 * grid.tolerance_ps / grid.clock_ps
        wrong = (np.abs(fewest - usual) > slack) & (np.abs(most - usual) > slack)
        if varies and 2 * wrong.sum() > len(k):
            return
        figures.latency_clocks = usual
        by = np.where(np.abs(fewest - usual) < np.abs(most - usual), fewest, most) - usual
    for i in np.flatnonzero(wrong).tolist():
        figures.moved.append({"line": int(number[i]), "k": int(k[i]), "at_ps": int(pulse[i]),
                              "latency_ns": float(latency[i]) / 1000, "by_clocks": round(float(by[i]), 2)})


def _held(latency, limit):
    """How many latencies lie from each one to ``limit`` above it, in rising order; and that order."""
    ordered = np.sort(latency)
    return np.searchsorted(ordered, ordered + limit, side="right") - np.arange(len(ordered)), ordered


def _all_pulses(lines):
    """Line number (from 1), k, edge and pulse of every pair, SYNC included as k = 0."""
    columns = [[], [], [], []]
    for number, line in enumerate(lines, start=1):
        if line.reference_ps is None:
            continue
        columns[0].append(np.full(len(line.k) + 1, number))
        columns[1].append(np.append(0, line.k))
        columns[2].append(np.append(line.reference_ps, line.edge_ps[line.k - 1]))
        columns[3].append(np.append(line.sync_ps, line.pulse_ps))
    return [np.concatenate(column) if column else np.empty(0, np.int64) for column in columns]


def _bin_phases(figures):
    """Where in the clock period the encoder edges of the lines were, in percent per bin."""
    grid = figures.grid
    if grid.tolerance_ps > grid.clock_ps / (2 * PHASE_BINS):
        figures.notes.append(
            f"times are known to {grid.tolerance_ps / 1000:g} ns only: phases within the clock cannot be shown")
        return
    if grid.phase_ps is None:
        figures.notes.append("the outputs do not keep to one phase of the clock, so its zero is not known: "
                             "phases are taken from the file's time zero, and latency in clocks from the least latency")
    times = figures.count.times_ps
    inside = np.zeros(len(times), dtype=bool)
    for line in figures.lines:
        inside |= (times >= (line.reference_ps or line.sync_ps)) & (times <= line.end_ps)
    if not inside.any():
        return
    phase = np.mod((times[inside] - (grid.phase_ps or 0)) / grid.clock_ps, 1)
    held, _ = np.histogram(phase, bins=PHASE_BINS, range=(0, 1))
    figures.phase_percent = 100 * held / held.sum()


def _say(figures):
    """Everything wrong, in words, in the order of the file."""
    say = figures.findings.append
    if not figures.lines:
        say("no SYNC edge: there is no reference, so no pulse can be placed")
    for number, line in enumerate(figures.lines, start=1):
        where = f"line {number}: " if len(figures.lines) > 1 else ""
        if line.reference_ps is None:
            say(f"{where}no encoder edge within {line.sync_window_ps[1] / 1000:g} ns before SYNC "
                f"at {line.sync_ps} ps (--latency-max-ns): the line has no reference")
        if not line.complete:
            beyond = f"; {line.unrecorded} pixels lie beyond it" if line.unrecorded else ""
            say(f"{where}the file ends while SYNC is active{beyond}")
        silent = line.expected >= 10 and 10 * len(line.k) < line.expected and not line.extra_ps.size
        if silent:
            say(f"{where}{len(line.k)} of {line.expected} pixels have a pulse: is this the pixel clock (--pixel)?")
        for k in line.missed.tolist() if not silent else ():
            due = f" (edge at {line.edge_ps[k - 1]} ps)" if k <= len(line.edge_ps) else " (its edge never came)"
            merged = ", merged with the pulse before" if k in line.merged else ""
            say(f"{where}pixel {k} is missing{due}{merged}")
        for at_ps in line.extra_ps.tolist():
            after = int(np.searchsorted(line.edge_ps, at_ps, side="right"))
            say(f"{where}extra pulse at {at_ps} ps, after the edge of pixel {min(after, line.expected)}")
    for at_ps in figures.outside_ps.tolist() if figures.lines else ():
        say(f"extra pulse at {at_ps} ps, outside any line")
    for moved in figures.moved:
        name = f"pixel {moved['k']}" if moved["k"] else "SYNC"
        where = f"line {moved['line']}: " if len(figures.lines) > 1 else ""
        say(f"{where}{name} is moved by {moved['by_clocks']:+g} clocks: latency {moved['latency_ns']:.3f} ns")
    latency = figures.latency_ps()
    if latency.size and np.ptp(latency) > figures.jitter_limit_ps():
        say(f"jitter {np.ptp(latency) / 1000:.3f} ns is more than a sampling clock of "
            f"{figures.grid.clock_ps / 1000:g} ns (--clock-ns) makes, {figures.jitter_limit_ps() / 1000:.3f} ns")
    for at_ps in figures.short_ps.tolist():
        say(f"short pulse at {at_ps} ps")
    illegal = figures.count.illegal_ps()
    if illegal.size:
        say(f"{illegal.size} illegal encoder edges, the first at {illegal[0]} ps: A and B changed together, "
            "so counts are lost")
