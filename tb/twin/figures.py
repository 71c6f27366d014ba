# SPDX-License-Identifier: BSD-2-Clause
"""``python -m tb.twin.figures``: the diagram of a serpentine scan in the manual, from what the virtual controller's pins do.

Two lines over the same places, SYNC and ENCODER over the position of the stage: the times are those of a scan that
``test_scans.py`` runs and holds to the exact ones.
"""

from pathlib import Path

from tb.twin.scans import TICK_CLOCKS, Field, exact, run

PATH = Path(__file__).resolve().parents[2] / "docs" / "figures" / "serpentine.svg"
FIELD = Field(n="24.4", length="0.006", lines=2, serpentine=True, speed="0.528")

LEFT, TOP, ROW, HIGH, BEFORE, AFTER, PIXELS_PER_COUNT = 130, 46, 30, 18, 14, 14, 2.2
STYLE = ("text{font:11px sans-serif;fill:#222}.t{font-weight:bold}.n{font-size:9px;fill:#777;text-anchor:middle}"
         ".g{stroke:#ddd}.o{fill:none;stroke:#111;stroke-width:1.5}.d{fill:#06c}")


def places(number, sync, end, pulses):
    """Positions, in counts from the start of the forward line, at which SYNC rises and falls and pulses rise."""
    assert exact(FIELD, number, sync, pulses) is not None
    per_clock = FIELD.step_q32() / 2**32 / TICK_CLOCKS
    begin, way = (FIELD.edges(0)[-1], -1) if number % 2 else (0, 1)
    return [begin + way * (t - sync) * per_clock for t in (sync, end, *pulses)]


def level(y, rises):
    """A path that is high between pairs of positions."""
    path, low = f"M{LEFT:g} {y + HIGH}", y + HIGH
    for a, b in rises:
        path += f"H{x(a):.1f}V{y}H{x(b):.1f}V{low}"
    return f'<path class="o" d="{path}H{x(length() + AFTER):.1f}"/>'


def x(counts):
    return LEFT + (counts + BEFORE) * PIXELS_PER_COUNT


def length():
    return FIELD.edges(0)[-1]


def render():
    lines, sampled, *_ = run(FIELD)
    edges = FIELD.edges(0)
    width, height = x(length() + AFTER) + 20, TOP + 4 * ROW + 60
    shapes = [f'<text class="t" x="8" y="18">serpentine, N = {FIELD.n}: both lines over the same encoder edges</text>']
    for edge in edges:
        shapes.append(f'<path class="g" d="M{x(edge):.1f} {TOP - 14}V{TOP + 4 * ROW + 16}"/>')
        shapes.append(f'<text class="n" x="{x(edge):.1f}" y="{TOP + 4 * ROW + 28}">{edge}</text>')
    shapes.append(f'<text class="n" x="{x(length() / 2):.1f}" y="{TOP + 4 * ROW + 44}">counts from the start of the line</text>')
    for number, (sync, end, *_rest) in enumerate(lines):
        start, stop, *pulses = places(number, sync, end, sampled[number])
        y = TOP + 2 * number * ROW + 8 * number
        arrow = "\u25c0 return" if number % 2 else "forward \u25b6"
        shapes.append(f'<text x="8" y="{y + 13}">{arrow}</text><text x="88" y="{y + 13}">SYNC</text>'
                      f'<text x="72" y="{y + ROW + 13}">ENCODER</text>')
        shapes.append(level(y, [sorted((start, stop))]))
        # A pulse is as long as it takes 6 counts; it begins at its pixel's edge, in the direction of the line.
        pulse = -6 if number % 2 else 6
        shapes.append(level(y + ROW, sorted(tuple(sorted((p, p + pulse))) for p in pulses)))
        for k, place in enumerate(pulses, 1):
            shapes.append(f'<text class="n d" x="{x(place):.1f}" y="{y + ROW - 3}">{k}</text>')
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height}">'
            f"<style>{STYLE}</style>\n" + "\n".join(shapes) + "\n</svg>\n")


if __name__ == "__main__":
    PATH.write_text(render())
