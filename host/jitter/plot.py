# SPDX-License-Identifier: BSD-2-Clause
"""The picture of a line: the motion, the pins, and how exactly the one follows the other."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.ticker import MaxNLocator

from .capture import Capture
from .statistics import Figures

INK, FAINT, GRID = "#1f2933", "#7b8794", "#e4e7eb"
BLUE, ORANGE, GREEN, RED = "#1f6feb", "#d9730d", "#2f855a", "#c53030"
ZOOMED_PIXELS = 12
STYLE = {
    "font.size": 9.5, "axes.edgecolor": FAINT, "axes.labelcolor": INK, "axes.titlesize": 10.5,
    "axes.titleweight": "semibold", "axes.titlecolor": INK, "axes.titlelocation": "left",
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True,
    "grid.color": GRID, "xtick.color": FAINT, "ytick.color": FAINT, "xtick.labelcolor": INK,
    "ytick.labelcolor": INK, "legend.frameon": False, "figure.facecolor": "white",
}


def draw(figures: Figures, capture: Capture, channels: tuple[str, str, str, str], path: Path,
         title: str | None = None, speed_mm_s: float | None = None):
    """Write a PNG of the first line that has pixels. ``channels`` names A, B, SYNC and the pixel clock.

    ``speed_mm_s`` draws the commanded speed beside the measured one.
    """
    line = next((line for line in figures.lines if len(line.k)), None)
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(13, 10.5), dpi=130)
        grid = figure.add_gridspec(4, 2, height_ratios=[1.35, 1.0, 1.5, 1.55], width_ratios=[1.9, 1],
                                   hspace=0.62, wspace=0.16, left=0.07, right=0.975, top=0.9, bottom=0.055)
        heading(figure, figures, title)
        if line is None:
            figure.text(0.5, 0.5, "no line with pixel pulses in this file", ha="center", size=14, color=RED)
        else:
            motion = figure.add_subplot(grid[0, :])
            _position(motion, figures, line)
            _velocity(figure.add_subplot(grid[1, :], sharex=motion), figures, line, speed_mm_s)
            _zoom(figure.add_subplot(grid[2, :]), figures, capture, channels, line)
            _latency(figure.add_subplot(grid[3, 0]), figures)
            _phases(figure.add_subplot(grid[3, 1]), figures)
        figure.savefig(path)
        plt.close(figure)


def heading(figure, figures, title):
    """Title, and the verdict under it."""
    latency = figures.latency_ps() / 1000
    figure.text(0.07, 0.965, title or "Scan line, measured at the pins", size=15, weight="bold", color=INK)
    exact = not figures.findings
    verdict = (f"{figures.pulses} pulses, N = {figures.divide.value():.10g}, {len(figures.lines)} SYNC: "
               f"{figures.missed()} missed, {figures.extra()} extra, {len(figures.moved)} moved")
    if latency.size:
        verdict += f", jitter {np.ptp(latency):.3f} ns peak to peak"
    figure.text(0.07, 0.937, verdict, size=11, color=GREEN if exact else RED)


def _span(figures, line):
    """Time around the line shown in the upper panels: the whole motion near it, in ps."""
    margin = (line.end_ps - line.sync_ps) // 8
    times = figures.count.times_ps
    return max(times[0], line.sync_ps - margin), min(times[-1], line.end_ps + margin)


def _mark_line(axes, line):
    """Shade the time SYNC is active; time zero is SYNC."""
    axes.axvspan(0, (line.end_ps - line.sync_ps) / 1e9, color=BLUE, alpha=0.07, lw=0)


def _position(axes, figures, line):
    start, end = _span(figures, line)
    times, counts = figures.count.times_ps, figures.count.counts
    inside = (times >= start) & (times <= end)
    thin = slice(None, None, max(1, int(inside.sum()) // 4000))
    per_mm = figures.settings.counts_per_mm
    scale = per_mm or 1
    milliseconds = (times[inside][thin] - line.sync_ps) / 1e9
    _mark_line(axes, line)
    axes.plot(milliseconds, counts[inside][thin] / scale, color=BLUE, lw=1.8)
    shown = line.k <= len(line.edge_ps)
    places = [0, len(line.k) - 1] if shown.all() and len(line.k) > 1 else []
    for place, name, side in zip(places, ("first", "last"), (1, -1)):
        at_ms = (line.pulse_ps[place] - line.sync_ps) / 1e9
        level = figures.count.at(int(line.pulse_ps[place])) / scale
        axes.plot(at_ms, level, "o", color=ORANGE, ms=5, zorder=3)
        axes.annotate(f"{name} pixel, k = {line.k[place]}", (at_ms, level), textcoords="offset points",
                      xytext=(8 * side, -12 * side * line.direction), color=ORANGE,
                      ha="left" if side > 0 else "right", va="center")
    axes.set_ylabel("position, mm" if per_mm else "position, counts")
    axes.set_title("Position, rebuilt from A and B (shaded: SYNC active)")
    axes.tick_params(labelbottom=False)
    axes.margins(x=0)


def _velocity(axes, figures, line, speed_mm_s):
    """Counts over a moving window: about one pixel, and never so few that counting them shows."""
    start, end = _span(figures, line)
    times, counts = figures.count.times_ps, figures.count.counts
    samples = np.linspace(start, end, 1500)
    window = max((end - start) / 400, 8 * (line.end_ps - line.sync_ps) / max(1, abs(line.end_counts - line.start_counts)))
    position = np.interp(np.concatenate([samples - window / 2, samples + window / 2]), times, counts)
    low, high = np.split(position, 2)
    per_mm = figures.settings.counts_per_mm
    speed = (high - low) / window * 1e12 / (per_mm or 1)
    valid = (samples - window / 2 >= times[0]) & (samples + window / 2 <= times[-1])
    _mark_line(axes, line)
    if speed_mm_s:
        axes.axhline(speed_mm_s * line.direction, color=FAINT, lw=1, ls=(0, (4, 3)),
                     label=f"commanded {speed_mm_s:g} mm/s")
        axes.legend(loc="lower center", handlelength=2.5)
    axes.plot((samples[valid] - line.sync_ps) / 1e9, speed[valid], color=GREEN, lw=1.3)
    axes.set_ylabel("mm/s" if per_mm else "counts/s")
    axes.set_xlabel("time from SYNC, ms")
    axes.set_title("Velocity")
    axes.yaxis.set_major_locator(MaxNLocator(4))


def _zoom(axes, figures, capture, channels, line):
    """The pins over SYNC and the first pixels, as a logic analyser shows them."""
    last = min(ZOOMED_PIXELS, len(line.edge_ps)) - 1
    pixel_ps = (line.edge_ps[last] - line.reference_ps) / (last + 1)
    start, end = line.sync_ps - 0.7 * pixel_ps, line.edge_ps[last] + 0.5 * pixel_ps
    labels = ("A", "B", "SYNC", "pixel clock")
    colours = (FAINT, FAINT, BLUE, ORANGE)
    for row, (name, label, colour) in enumerate(zip(channels, labels, colours)):
        base = 3 - row
        trace = capture.traces[name]
        inside = trace.toggles_ps[(trace.toggles_ps > start) & (trace.toggles_ps < end)]
        # A pulse too narrow to be seen at this scale is drawn as its line, which the steps give.
        at = (np.concatenate([[start], inside, [end]]) - line.sync_ps) / 1e6
        first = trace.level_at(int(start))
        levels = (first + np.arange(len(inside) + 2)) % 2
        levels[-1] = levels[-2]
        axes.step(at, base + 0.62 * levels, where="post", color=colour, lw=0.9 if row < 2 else 1.5)
        if row == 2:
            axes.fill_between(at, base, base + 0.62 * levels, step="post", color=colour, alpha=0.12, lw=0)
    for k in line.k[line.k <= last + 1].tolist():
        axes.text((line.edge_ps[k - 1] - line.sync_ps) / 1e6, 0.72, str(k), color=ORANGE, ha="center", size=8.5)
    axes.set_yticks([3.31, 2.31, 1.31, 0.31], labels)
    axes.set_ylim(-0.12, 3.85)
    axes.set_xlim((start - line.sync_ps) / 1e6, (end - line.sync_ps) / 1e6)
    axes.grid(axis="y", visible=False)
    axes.set_xlabel("time from SYNC, µs")
    axes.set_title(f"SYNC and the first {last + 1} pixels")


def _latency(axes, figures):
    """Histogram of edge to pulse; SYNC's own latency is a mark."""
    latency = figures.latency_ps() / 1000
    clock = figures.settings.clock_ps / 1000
    low = np.floor(latency.min() / clock) * clock
    high = max(np.ceil(latency.max() / clock) * clock, low + clock)
    bins = np.linspace(low, high, int(min(200, round((high - low) / clock * 25))) + 1)
    axes.hist(latency, bins=bins, color=ORANGE, alpha=0.85, edgecolor="white", lw=0.4)
    for line in figures.lines:
        if line.reference_ps is not None:
            axes.plot(line.sync_latency_ps() / 1000, 0, "^", color=BLUE, ms=9, clip_on=False, zorder=4)
    axes.plot([], [], "^", color=BLUE, ms=8, label="SYNC")
    axes.axvline(latency.min(), color=INK, lw=0.9, ls=":")
    axes.axvline(latency.max(), color=INK, lw=0.9, ls=":")
    axes.set_xlim(low - 0.35 * clock, high + 0.35 * clock)
    axes.set_ylim(0, axes.get_ylim()[1] * 1.3)
    axes.text(0.02, 0.95, f"{latency.min():.3f} to {latency.max():.3f} ns\n{np.ptp(latency):.3f} ns peak to peak, "
              f"{np.std(latency):.3f} ns rms", transform=axes.transAxes, va="top", color=INK)
    axes.legend(loc="upper right")
    axes.set_xlabel("encoder edge to its pulse, ns")
    axes.set_ylabel("pulses")
    clocks = "" if figures.latency_clocks is None else f"{figures.latency_clocks} clocks after the sampling clock"
    axes.set_title(f"Latency of every pulse: {clocks}")


def _phases(axes, figures):
    """How evenly the edges fell on the clock period: else the jitter would not be exercised."""
    axes.set_title("Encoder edges over the clock period")
    if figures.phase_percent is None:
        axes.text(0.5, 0.5, "the file's times are too coarse", ha="center", va="center", color=FAINT,
                  transform=axes.transAxes)
        return
    clock = figures.settings.clock_ps / 1000
    width = clock / len(figures.phase_percent)
    axes.axhspan(5, 15, color=GREEN, alpha=0.1, lw=0)
    axes.bar((np.arange(len(figures.phase_percent)) + 0.5) * width, figures.phase_percent, width=width * 0.86,
             color=GREEN, alpha=0.85)
    axes.set_ylim(0, max(20, figures.phase_percent.max() * 1.15))
    axes.set_xlim(0, clock)
    axes.set_xlabel("edge after the clock, ns")
    axes.set_ylabel("% of edges (band: 5 to 15)")
