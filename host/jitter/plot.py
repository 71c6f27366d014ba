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
FIRST_PIXELS, LAST_PIXELS = 10, 4
MARGIN, MARGIN_PS = 0.35, 80_000_000_000                     # shown on either side: of the line, and at least
STYLE = {
    "font.size": 9.5, "axes.edgecolor": FAINT, "axes.labelcolor": INK, "axes.titlesize": 10.5,
    "axes.titleweight": "bold", "axes.titlecolor": INK, "axes.titlelocation": "left",
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True,
    "grid.color": GRID, "xtick.color": FAINT, "ytick.color": FAINT, "xtick.labelcolor": INK,
    "ytick.labelcolor": INK, "legend.frameon": False, "figure.facecolor": "white",
}


def draw(figures: Figures, capture: Capture, channels: tuple[str, str, str, str], path: Path,
         title: str | None = None, speed_mm_s: float | None = None,
         deviation: tuple[np.ndarray, np.ndarray] | None = None):
    """Write a PNG of the first line that has pixels. ``channels`` names A, B, SYNC and the pixel clock.

    ``speed_mm_s`` draws the commanded speed beside the measured one. ``deviation`` is time in ps and
    distance from the commanded motion in counts, and gets a panel of its own.
    """
    line = next((line for line in figures.lines if len(line.k)), None)
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(13, 13.2 if deviation else 12), dpi=130)
        heading(figure, figures, title)
        if line is None:
            figure.text(0.5, 0.5, "no line with pixel pulses in this file", ha="center", size=14, color=RED)
        else:
            heights = [1.3, 0.34, 0.8] + ([0.62] if deviation else [])
            side = {"left": 0.075, "right": 0.975}
            outer = figure.add_gridspec(3, 1, height_ratios=[sum(heights) + 0.2, 1.35, 1.45], hspace=0.26,
                                        top=0.915, bottom=0.045, **side)
            motion = outer[0].subgridspec(len(heights), 1, height_ratios=heights, hspace=0.3)
            pins = outer[1].subgridspec(1, 2, width_ratios=[1.9, 1], wspace=0.08)
            shares = outer[2].subgridspec(1, 2, width_ratios=[1.9, 1], wspace=0.16)
            _motion([figure.add_subplot(row) for row in motion], figures, capture, channels, line, speed_mm_s,
                    deviation)
            start = figure.add_subplot(pins[0])
            _zoom(start, figures, capture, channels, line, 1, FIRST_PIXELS)
            _zoom(figure.add_subplot(pins[1], sharey=start), figures, capture, channels, line,
                  max(1, int(line.k[-1]) - LAST_PIXELS + 1), int(line.k[-1]))
            _latency(figure.add_subplot(shares[0]), figures)
            _phases(figure.add_subplot(shares[1]), figures)
        figure.savefig(path)
        plt.close(figure)


def heading(figure, figures, title):
    """Title, and the verdict under it."""
    latency = figures.latency_ps() / 1000
    figure.text(0.075, 0.97, title or "Scan line, measured at the pins", size=15, weight="bold", color=INK)
    exact = not figures.findings
    verdict = (f"{figures.pulses} pulses, N = {figures.divide.value():.10g}, {len(figures.lines)} SYNC: "
               f"{figures.missed()} missed, {figures.extra()} extra, {len(figures.moved)} moved")
    if latency.size:
        verdict += f", jitter {np.ptp(latency):.3f} ns peak to peak"
    figure.text(0.075, 0.947, verdict, size=11, color=GREEN if exact else RED)


def _motion(panels, figures, capture, channels, line, speed_mm_s, deviation):
    """The panels over the whole motion, which share their time axis: milliseconds from SYNC."""
    margin = max(int((line.end_ps - line.sync_ps) * MARGIN), MARGIN_PS)
    times = figures.count.times_ps
    start, end = max(times[0], line.sync_ps - margin), min(times[-1], line.end_ps + margin)
    _position(panels[0], figures, line, start, end)
    _strip(panels[1], capture, channels, line)
    _velocity(panels[2], figures, line, start, end, speed_mm_s)
    if deviation:
        _deviation(panels[3], line, *deviation)
    for panel in panels:
        panel.set_xlim((start - line.sync_ps) / 1e9, (end - line.sync_ps) / 1e9)
        panel.axvspan(0, (line.end_ps - line.sync_ps) / 1e9, color=BLUE, alpha=0.07, lw=0)
        panel.tick_params(labelbottom=panel is panels[-1])
    panels[-1].set_xlabel("time from SYNC, ms")
    panels[0].figure.align_ylabels(panels)


def _position(axes, figures, line, start, end):
    times, counts = figures.count.times_ps, figures.count.counts
    inside = (times >= start) & (times <= end)
    thin = slice(None, None, max(1, int(inside.sum()) // 4000))
    per_mm = figures.settings.counts_per_mm
    scale = per_mm or 1
    axes.plot((times[inside][thin] - line.sync_ps) / 1e9, counts[inside][thin] / scale, color=BLUE, lw=1.8)
    for place, side in ((0, 1), (-1, -1)):
        at_ms = (line.pulse_ps[place] - line.sync_ps) / 1e9
        level = figures.count.at(int(line.pulse_ps[place])) / scale
        axes.plot(at_ms, level, "o", color=ORANGE, ms=5, zorder=3)
        axes.annotate(f"pixel {line.k[place]}", (at_ms, level), textcoords="offset points",
                      xytext=(10 * side, -5 * side * line.direction), color=ORANGE,
                      ha="left" if side > 0 else "right", va="center")
    axes.set_ylabel("mm" if per_mm else "counts")
    axes.set_title("Position, rebuilt from A and B")


def _strip(axes, capture, channels, line):
    """SYNC and the pixel clock over the whole motion; pulses too close to tell apart make a band."""
    for base, name, colour in ((1.25, channels[2], BLUE), (0, channels[3], ORANGE)):
        trace = capture.traces[name]
        at_ms = (np.concatenate([[0], trace.toggles_ps, [capture.end_ps]]) - line.sync_ps) / 1e9
        levels = (trace.initial + np.arange(len(at_ms))) % 2
        levels[-1] = levels[-2]
        axes.step(at_ms, base + levels, where="post", color=colour, lw=1.4 if base else 0.25)
    axes.set_yticks([1.75, 0.5], ["SYNC", "pixels"])
    axes.set_ylim(-0.2, 2.45)
    axes.grid(axis="y", visible=False)
    axes.tick_params(axis="y", length=0)


def _velocity(axes, figures, line, start, end, speed_mm_s):
    """Counts over a moving window, never so few that counting them shows."""
    times, counts = figures.count.times_ps, figures.count.counts
    samples = np.linspace(start, end, 2000)
    count_ps = (line.end_ps - line.sync_ps) / max(1, abs(line.end_counts - line.start_counts))
    window = max((end - start) / 400, 8 * count_ps)
    low, high = (np.interp(samples + side * window / 2, times, counts) for side in (-1, 1))
    per_mm = figures.settings.counts_per_mm
    speed = (high - low) / window * 1e12 / (per_mm or 1)
    if speed_mm_s:
        axes.axhline(speed_mm_s * line.direction, color=INK, lw=1, ls=(0, (4, 3)),
                     label=f"commanded {speed_mm_s * line.direction:g} mm/s")
        axes.legend(loc="center", handlelength=2.5)
    axes.plot((samples - line.sync_ps) / 1e9, speed, color=GREEN, lw=1.4)
    axes.set_ylabel("mm/s" if per_mm else "counts/s")
    axes.set_title("Velocity")
    axes.yaxis.set_major_locator(MaxNLocator(4))
    axes.margins(y=0.15)


def _deviation(axes, line, times_ps, counts):
    """Distance from the commanded motion."""
    axes.axhline(0, color=INK, lw=0.8)
    axes.plot((times_ps - line.sync_ps) / 1e9, counts, color=GREEN, lw=0.9)
    axes.set_ylabel("counts")
    axes.set_title(f"Deviation from the commanded line: {np.sqrt(np.mean(counts**2)):.2f} counts rms, "
                   f"{np.abs(counts).max():.2f} at most")
    axes.yaxis.set_major_locator(MaxNLocator(4))


def _zoom(axes, figures, capture, channels, line, first_k, last_k):
    """The pins around pixels ``first_k`` to ``last_k``, as a logic analyser shows them."""
    last_k = min(last_k, len(line.edge_ps))
    pixel_ps = (line.edge_ps[last_k - 1] - line.reference_ps) / last_k
    start = (line.sync_ps if first_k == 1 else line.edge_ps[first_k - 1]) - 0.5 * pixel_ps
    end = line.edge_ps[last_k - 1] + (0.5 if first_k == 1 else 0.9) * pixel_ps
    for row, (name, colour) in enumerate(zip(channels, (FAINT, FAINT, BLUE, ORANGE))):
        base = 3 - row
        trace = capture.traces[name]
        inside = trace.toggles_ps[(trace.toggles_ps > start) & (trace.toggles_ps < end)]
        at_us = (np.concatenate([[start], inside, [end]]) - line.sync_ps) / 1e6
        levels = (trace.level_at(int(start)) + np.arange(len(at_us))) % 2
        levels[-1] = levels[-2]
        axes.step(at_us, base + 0.62 * levels, where="post", color=colour, lw=0.8 if row < 2 else 1.5)
        if row == 2:
            axes.fill_between(at_us, base, base + 0.62 * levels, step="post", color=colour, alpha=0.12, lw=0)
    for k in line.k[(line.k >= first_k) & (line.k <= last_k)].tolist():
        axes.text((line.edge_ps[k - 1] - line.sync_ps) / 1e6, 0.72, str(k), color=ORANGE, ha="center", size=8.5)
    axes.set_yticks([3.31, 2.31, 1.31, 0.31], ("A", "B", "SYNC", "pixels"))
    axes.tick_params(axis="y", length=0, labelleft=first_k == 1)
    axes.set_ylim(-0.12, 3.85)
    axes.set_xlim((start - line.sync_ps) / 1e6, (end - line.sync_ps) / 1e6)
    axes.grid(axis="y", visible=False)
    axes.ticklabel_format(axis="x", useOffset=False, style="plain")
    axes.xaxis.set_major_locator(MaxNLocator(5 if first_k > 1 else 8, prune="both"))
    axes.set_xlabel("time from SYNC, µs")
    axes.set_title(f"SYNC and pixels 1 to {last_k}" if first_k == 1 else f"pixels {first_k} to {last_k}")


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
    axes.set_ylim(0, axes.get_ylim()[1] * 1.35)
    axes.text(0.5, 0.96, f"{latency.min():.3f} to {latency.max():.3f} ns\n{np.ptp(latency):.3f} ns peak to peak, "
              f"{np.std(latency):.3f} ns rms", transform=axes.transAxes, va="top", ha="center", color=INK)
    axes.legend(loc="upper right")
    axes.set_xlabel("encoder edge to its pulse, ns")
    axes.set_ylabel("pulses")
    known = figures.latency_clocks is not None and figures.grid.phase_ps is not None
    clocks = f": {figures.latency_clocks} clocks after the sampling clock" if known else ""
    axes.set_title(f"Latency of every pulse{clocks}")


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
    axes.set_yticks(np.arange(0, axes.get_ylim()[1] + 1, 5))
    axes.set_xlim(0, clock)
    axes.set_xlabel("edge after the clock, ns")
    axes.set_ylabel("% of edges (band: 5 to 15)")
