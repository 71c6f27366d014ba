# SPDX-License-Identifier: BSD-2-Clause
"""Published figures of the MS-2000 controller, to set ours beside.

The figures come from the vendor's public manual and web pages on its scan module. The jitter of its pulses
is not published; they are made in a processor interrupt, and 3 to 10 us is what the same vendor states for
another output made that way.
"""

from __future__ import annotations

# name -> (what the original has, its best and worst figure in the row's unit where a ratio makes sense,
# whether less is better)
ORIGINAL: dict[str, tuple[str, tuple[float, float] | None, bool]] = {
    "pixels": ("1891 in the worked example", None, True),
    "missed, extra, moved": ("checked by the end position only", None, True),
    "edge to pulse": ("not published; 3 to 10 us by analogy", (3.0, 10.0), True),
    "jitter, peak to peak": ("not published; up to 7 us by analogy", (3.0, 7.0), True),
    "jitter, rms": ("not published", None, True),
    "edge to SYNC": ("not published (compare chip)", None, True),
    "period jitter": ("not published", None, True),
    "pixel clock": ("38.6 kHz at most (N = 8, 6.8 mm/s)", None, False),
    "pulse width": ("not published", None, True),
    "counts per pixel": ("8 to 32767, multiples of 4", None, True),
    "pixel": ("0.52868 um in the worked example", None, True),
    "following error, rms": ('"a few" counts', (3.0, 3.0), True),
    "following error, max": ("not published", None, True),
    "left over at the end": ("12 counts in the worked example", None, True),
}


def table(rows: list[tuple[str, str, float | None]]) -> list[str]:
    """Lines of text: name, ours, the original's, and how many times better, where both have a number and it is better."""
    cells = [("", "measured", "original", "times better")]
    for name, ours, number in rows:
        theirs, span, less = ORIGINAL.get(name, ("", None, True))
        ratio = ""
        if span and number:
            low, high = (s / number if less else number / s for s in span)
            if round(low) > 1:
                ratio = f"{low:.0f}" if round(low) == round(high) else f"{low:.0f} to {high:.0f}"
        cells.append((name, ours, theirs, ratio))
    widths = [max(len(row[i]) for row in cells) for i in range(4)]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in cells]
