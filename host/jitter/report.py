# SPDX-License-Identifier: BSD-2-Clause
"""The figures as JSON, and as text beside the original's."""

from __future__ import annotations

import numpy as np

from . import original
from .statistics import PHASE_BIN_PERCENT, Figures

LISTED = 1000


def as_dict(figures: Figures) -> dict:
    """The figures under their names in ``report.json``.

    Times are in ns, positions in counts. ``pixels`` is the number of pulses on the pin. ``start_counts``
    is that of the first line, ``end_counts`` that of the last; ``lines`` has them all.
    """
    latency = figures.latency_ps() / 1000
    period = figures.period_jitter_clocks()
    sync = [line.sync_latency_ps() for line in figures.lines if line.reference_ps is not None]
    lines = [line for line in figures.lines if line.reference_ps is not None]
    phases = figures.phase_percent
    return {
        "pixels": figures.pulses,
        "pixels_expected": sum(line.expected for line in figures.lines),
        "missed": figures.missed(),
        "extra": figures.extra(),
        "moved": len(figures.moved),
        "sync_edges": len(figures.lines),
        "start_counts": lines[0].start_counts if lines else None,
        "end_counts": lines[-1].end_counts if lines else None,
        "latency_ns": _span(latency),
        "latency_clocks": figures.latency_clocks,
        "sync_latency_ns": _span(np.array(sync) / 1000),
        "jitter_ns": {"pp": _round(np.ptp(latency)), "rms": _round(np.std(latency))} if latency.size else None,
        "jitter_limit_ns": figures.jitter_limit_ps() / 1000,
        "period_jitter_clocks": {"max": _round(np.abs(period).max()), "rms": _round(np.sqrt(np.mean(period**2)))}
        if period.size else None,
        "phase_bins": [round(float(p), 2) for p in phases] if phases is not None else None,
        "phase_bins_spread": bool(phases_are_spread(figures)) if phases is not None else None,
        "clock_ns": figures.settings.clock_ps / 1000,
        "clock_phase_ns": None if figures.grid.phase_ps is None else _round(figures.grid.phase_ps / 1000),
        "resolution_ns": figures.grid.tolerance_ps / 1000,
        "counts_per_pixel": figures.divide.value(),
        "counts_per_pixel_source": figures.divide_source,
        "pixel_rate_hz": pixel_rate_hz(figures),
        "pulse_width_ns": _span(figures.widths_ps / 1000),
        "merged": sum(len(line.merged) for line in figures.lines),
        "short": len(figures.short_ps),
        "illegal_edges": len(figures.count.illegal_ps()),
        "findings": figures.findings[:LISTED],
        "notes": figures.notes,
        "moved_pulses": figures.moved[:LISTED],
        "lines": [_line(line) for line in figures.lines],
    }


def phases_are_spread(figures: Figures) -> bool:
    """Whether every bin of the clock period holds its share, 5 to 15 %."""
    low, high = PHASE_BIN_PERCENT
    return bool(np.all((figures.phase_percent >= low) & (figures.phase_percent <= high)))


def pixel_rate_hz(figures: Figures) -> float | None:
    """Mean pixel clock over the lines."""
    spans = [(line.k[-1] - line.k[0], line.pulse_ps[-1] - line.pulse_ps[0])
             for line in figures.lines if len(line.k) > 1]
    periods, time_ps = map(sum, zip(*spans)) if spans else (0, 0)
    return round(float(periods * 1e12 / time_ps), 3) if time_ps else None


def as_text(figures: Figures, more_rows=()) -> str:
    """The report for a person: verdict, findings, and the figures beside the original's.

    ``more_rows`` are rows as :func:`measured_rows` makes them, of figures that pins alone do not show.
    """
    result = as_dict(figures)
    verdict = "exact" if not result["findings"] else plural(len(figures.findings), "finding")
    text = [
        f"{plural(result['pixels'], 'pixel pulse')} in {plural(result['sync_edges'], 'line')}, N = {result['counts_per_pixel']:.10g} "
        f"({result['counts_per_pixel_source']}): {verdict}",
        "",
    ]
    text += [f"  {finding}" for finding in figures.findings[:40]]
    if len(figures.findings) > 40:
        text.append(f"  ... and {len(figures.findings) - 40} more; the JSON has them")
    text += [""] if figures.findings else []
    text += original.table(measured_rows(figures, result) + list(more_rows))
    if result["phase_bins"]:
        bins = " ".join(f"{share:.1f}" for share in result["phase_bins"])
        judged = "spread" if result["phase_bins_spread"] else "NOT spread: the jitter is not fully exercised"
        text += ["", f"encoder edges over the clock period, percent in ten bins: {bins} ({judged})"]
    text += [f"note: {note}" for note in figures.notes]
    return "\n".join(text) + "\n"


def measured_rows(figures: Figures, result: dict) -> list[tuple[str, str, float | None]]:
    """(name, our figure in words, our figure in the original's unit) for every row of the table we can fill."""
    rows = [
        ("pixels", f"{result['pixels']} of {result['pixels_expected']}", None),
        ("missed, extra, moved", f"{result['missed']}, {result['extra']}, {result['moved']}", None),
    ]
    if result["latency_ns"]:
        latency, jitter, clocks = result["latency_ns"], result["jitter_ns"], result["latency_clocks"]
        # Only a clock whose phase is known tells when it sampled.
        sampled = f" ({clocks} clocks after sampling)" if figures.grid.phase_ps is not None and clocks else ""
        rows += [
            ("edge to pulse", f"{_range(latency)}{sampled}", latency["max"] / 1000),
            ("jitter, peak to peak", f"{jitter['pp']:.3f} ns", jitter["pp"] / 1000),
            ("jitter, rms", f"{jitter['rms']:.3f} ns", None),
        ]
    if result["sync_latency_ns"]:
        rows.append(("edge to SYNC", _range(result["sync_latency_ns"]), None))
    if result["period_jitter_clocks"]:
        clocks = result["period_jitter_clocks"]["max"]
        most = f"{clocks:.3f} clocks" if result["latency_clocks"] else f"{clocks * result['clock_ns']:.3f} ns"
        rows.append(("period jitter", f"{most} at most", None))
    if result["pixel_rate_hz"]:
        rows.append(("pixel clock", f"{result['pixel_rate_hz'] / 1000:.4g} kHz", result["pixel_rate_hz"] / 1000))
    if result["pulse_width_ns"]:
        rows.append(("pulse width", f"{result['pulse_width_ns']['mean']:.6g} ns", None))
    rows.append(("counts per pixel", f"{result['counts_per_pixel']:.10g}, any from 1, with fraction", None))
    per_mm = figures.settings.counts_per_mm
    if per_mm:
        rows.append(("pixel", f"{1000 * result['counts_per_pixel'] / per_mm:.5f} um", None))
    return rows


def plural(number: int, noun: str) -> str:
    """``1 line``, ``2 lines``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _range(span_ns) -> str:
    low, high = f"{span_ns['min']:.3f}", f"{span_ns['max']:.3f}"
    return f"{low} ns" if low == high else f"{low} to {high} ns"


def _line(line) -> dict:
    return {
        "direction": line.direction, "complete": line.complete, "start_counts": line.start_counts,
        "end_counts": line.end_counts, "pixels_expected": line.expected, "pixels": len(line.k),
        "missed_k": line.missed.tolist()[:LISTED], "merged_k": line.merged.tolist()[:LISTED],
        "extra_ps": line.extra_ps.tolist()[:LISTED], "sync_ps": line.sync_ps, "end_ps": line.end_ps,
    }


def _span(values) -> dict | None:
    if not len(values):
        return None
    return {"min": _round(np.min(values)), "max": _round(np.max(values)), "mean": _round(np.mean(values))}


def _round(value) -> float:
    return round(float(value), 6)
