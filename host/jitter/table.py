# SPDX-License-Identifier: BSD-2-Clause
"""Read channels from a logic analyser's CSV: a row per change, or a row per sample.

Understood: a header row with a time column and one column per channel (Saleae: ``Time [s],Channel 0``);
comment rows with ``Channels`` and ``Samplerate`` before columns of samples without a time (sigrok).
Time is in seconds unless its column's name ends in a unit: ``time_ns``, ``Time [us]``, ``t (ms)``.
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import numpy as np

from .capture import Capture, CaptureError, Trace, choose

UNIT_PS = {"s": 10**12, "ms": 10**9, "us": 10**6, "µs": 10**6, "ns": 10**3, "ps": 1}
RATE_HZ = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9}


def read_table(path: Path, wanted: list[str], samplerate_hz: Fraction | None = None) -> Capture:
    """Read the channels ``wanted``. ``samplerate_hz`` overrides the file's where rows carry no time."""
    lines = Path(path).read_text(encoding="utf-8-sig", errors="replace").splitlines(keepends=True)
    comments = []
    while lines and lines[0].lstrip()[:1] in ("", ";", "#"):
        comments.append(lines.pop(0))
    if not lines:
        raise CaptureError(f"{path}: no rows")
    cut_short = not lines[-1].endswith("\n")
    if cut_short:
        lines.pop()
    if not lines:
        raise CaptureError(f"{path}: no complete row")
    separator = max(",;\t", key=lines[0].count)
    names, rate_in_file = _comments(comments)
    header = [field.strip().strip('"') for field in lines[0].split(separator)]
    if not all(_is_number(field) for field in header):
        lines.pop(0)
        # sigrok may name its columns only by their kind; then the comment's names count.
        if not (names and set(header) <= {"logic", "analog"}):
            names = header
    elif names is None:
        raise CaptureError(f"{path}: no header row naming the channels, first row is {header}")
    if not lines:
        raise CaptureError(f"{path}: a header but no rows")
    if len(names) + 1 == len(header):                        # names came from a comment: time is extra
        names = ["time", *names]
    time_column, unit_ps = _time_column(names)
    channels = [name for i, name in enumerate(names) if i != time_column]
    columns = {name: names.index(choose(channels, name)) for name in wanted}
    used = sorted(set(columns.values()) | ({time_column} if time_column is not None else set()))
    try:
        rows = np.loadtxt(lines, delimiter=separator, usecols=used, ndmin=2, dtype=np.float64)
    except ValueError as error:
        raise CaptureError(f"{path}: a row is not all numbers: {error}") from None
    if time_column is None:
        rate = samplerate_hz or rate_in_file
        if not rate:
            raise CaptureError(f"{path}: no time column and no sample rate; give --samplerate")
        # Integer arithmetic: a sample's time must not drift by rounding.
        rate = Fraction(rate)
        times = np.arange(len(rows), dtype=object) * (10**12 * rate.denominator) // rate.numerator
        times_ps = times.astype(np.int64)
    else:
        times_ps = np.rint(rows[:, used.index(time_column)] * unit_ps).astype(np.int64)
        if np.any(np.diff(times_ps) < 0):
            row = int(np.argmax(np.diff(times_ps) < 0)) + 2
            raise CaptureError(f"{path}: time goes backwards at row {row}")
    traces = {
        name: Trace.from_changes(times_ps, rows[:, used.index(column)] > 0.5)
        for name, column in columns.items()
    }
    return Capture(traces, int(times_ps[-1]), cut_short)


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _comments(comments):
    """Channel names and sample rate, where comment rows give them."""
    names = rate = None
    for line in comments:
        if found := re.search(r"Channels[^:]*:\s*(.+)", line):
            names = [name.strip() for name in found[1].split(",")]
        if found := re.search(r"Samplerate\s*[:=]\s*([\d.]+)\s*([kMG]?)Hz", line, re.IGNORECASE):
            rate = Fraction(found[1]) * RATE_HZ[found[2].lower()]
    return names, rate


def _time_column(names):
    """Index of the time column (None without one) and picoseconds per unit."""
    for i, name in enumerate(names):
        if found := re.fullmatch(r"(?:time|t|timestamp)(?:[ _\[(]*([munpµ]?s)[\])]*)?", name, re.IGNORECASE):
            return i, UNIT_PS[(found[1] or "s").lower()]
    return None, None
