# SPDX-License-Identifier: BSD-2-Clause
"""The manual's timing diagrams: ``python -m tb.vectors.figures`` renders every scenario table as SVG.

``docs/figures/<block>-<n>.svg`` shows scenario n of ``<block>.toml``, so a figure in the manual is what
``tb/rtl/test_scan_line.py`` checks clock by clock.  Output depends on the tables alone.
"""

import argparse
import sys
from html import escape
from pathlib import Path

from tb.vectors import OUTPUTS, PINS, load

__all__ = ["BLOCKS", "files"]

BLOCKS = ("compare", "divider", "router")
DIRECTORY = Path(__file__).resolve().parents[2] / "docs" / "figures"

LEFT, TOP, CLOCK, ROW, HIGH = 96, 44, 18, 26, 16
"""Margins, width of a clock, height of a row and of a level in it; pixels."""

STYLE = ("text{font:11px sans-serif;fill:#222}.t{font-weight:bold}.g{stroke:#ddd;stroke-width:1}"
         ".n{font-size:9px;fill:#777;text-anchor:middle}.v{font-size:10px;text-anchor:middle}"
         ".i{fill:none;stroke:#06c;stroke-width:1.5}.o{fill:none;stroke:#111;stroke-width:1.5}"
         ".d{font-size:10px;fill:#06c;text-anchor:middle}")


def _runs(values):
    """``[(first clock, one past the last, value)]`` of equal neighbours."""
    starts = [n for n in range(len(values)) if n == 0 or values[n] != values[n - 1]]
    return [(a, b, values[a]) for a, b in zip(starts, starts[1:] + [len(values)])]


def _level(y, values, style):
    """A line that is high where the value is not 0."""
    path = ""
    for start, stop, value in _runs(values):
        height = y + (0 if value else HIGH)
        path += f"{'L' if path else 'M'}{LEFT + start * CLOCK} {height}H{LEFT + stop * CLOCK}"
    return [f'<path class="{style}" d="{path}"/>']


def _number(y, values, style):
    """A box for every value, with the value in it."""
    shapes = []
    for start, stop, value in _runs(values):
        x, width = LEFT + start * CLOCK, (stop - start) * CLOCK
        shapes.append(f'<path class="{style}" d="M{x} {y}h{width}v{HIGH}h{-width}z"/>')
        shapes.append(f'<text class="v" x="{x + width // 2}" y="{y + 12}">{value}</text>')
    return shapes


def _positions(scenario, axis):
    position = scenario.setup[("start", "start_y")[axis]]
    result = []
    for clock in range(scenario.clocks):
        position += scenario.inputs.get(clock, {}).get(f"step{axis}", 0)
        result.append(position)
    return result


def _rows(scenario):
    """``[(label, drawing function, values, style)]`` from top to bottom."""
    rows = []
    for axis, label in (0, "X, counts"), (1, "Y, counts"):
        positions = _positions(scenario, axis)
        if len(set(positions)) > 1:
            rows.append((label, _number, positions, "i"))
    for name in OUTPUTS:
        values = scenario.outputs.get(name)
        if values is None or name == "out0" and not any(values):
            continue
        rows.append((name.upper() if name in PINS else name,
                     _level if name in (*PINS, "armed", "late") else _number, values, "o"))
    return rows


def _events(scenario):
    """``[(clock, line, text)]`` of armings and changes of route; several of one clock on lines of their own."""
    return [(clock, line, name if name in ("arm", "disarm") else f"{name}={value}")
            for clock, given in sorted(scenario.inputs.items())
            for line, (name, value) in enumerate((name, value) for name, value in given.items()
                                                 if not name.startswith("step"))]


def _setup(scenario):
    setup, routes = scenario.setup, scenario.routes
    n = setup["whole"] + setup["fraction"] / 2**32
    words = [f"reference edge {setup['reference']}", "toward -" if setup["reverse"] else "toward +", f"N = {n:g}"]
    words.append(f"{setup['pixels']} pixel{'s' * (setup['pixels'] > 1)}")
    words.append({0: "phi = 0", 0xffffffff: "phi = 1 - 2^-32"}.get(setup["phase"], f"phi = {setup['phase']:#x}"))
    if setup["width"] > 1:
        words.append(f"width {setup['width']}")
    if not setup["emit"]:
        words.append("no emit")
    if setup["pixel_axis"]:
        words.append("pixels of Y")
    words += [f"{name} = {value}" for name, value in routes.items()
              if value != {"sync": 2, "encoder": 3}.get(name, 0)]
    return ", ".join(words)


def render(scenario):
    """The scenario as the text of an SVG file."""
    rows, events = _rows(scenario), _events(scenario)
    active = [clock for values in [*scenario.outputs.values(), *(row[2] for row in rows)]
              for clock, stop, _ in _runs(values)]
    clocks = min(scenario.clocks, max([*active, *(clock for clock, *_ in events)]) + 5)
    top = TOP + 18 + 12 * max((line for _, line, _ in events), default=0)
    width = max(LEFT + clocks * CLOCK + 12, 560)
    height = top + len(rows) * ROW + 8
    shapes = [f'<rect width="{width}" height="{height}" fill="#fff"/>',
              f'<text class="t" x="8" y="16">{escape(scenario.name)}</text>',
              f'<text x="8" y="32">{escape(_setup(scenario))}</text>',
              f'<text x="8" y="{top - 4}">fast clock</text>']
    for clock in range(0, clocks + 1):
        x = LEFT + clock * CLOCK
        shapes.append(f'<path class="g" d="M{x} {top}V{height - 4}"/>')
        if clock < clocks:
            shapes.append(f'<text class="n" x="{x + CLOCK // 2}" y="{top - 4}">{clock}</text>')
    for clock, line, text in events:
        x = LEFT + clock * CLOCK + CLOCK // 2
        shapes.append(f'<text class="d" x="{x}" y="{top - 16 - 12 * line}">{escape(text)}</text>')
    for n, (label, draw, values, style) in enumerate(rows):
        y = top + n * ROW + 6
        shapes.append(f'<text x="8" y="{y + 12}">{escape(label)}</text>')
        shapes += draw(y, values[:clocks], style)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
            f'viewBox="0 0 {width} {height}"><style>{STYLE}</style>\n' + "\n".join(shapes) + "\n</svg>\n")


def files():
    """``{path: text}`` of all figures."""
    return {DIRECTORY / f"{block}-{n}.svg": render(scenario)
            for block in BLOCKS for n, scenario in enumerate(load(block), 1)}


def main():
    parser = argparse.ArgumentParser(prog="python -m tb.vectors.figures", description="Render the scenario tables.")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if a figure is stale")
    check, stale = parser.parse_args().check, []
    for path, text in files().items():
        if not path.exists() or path.read_text() != text:
            stale.append(path.name)
            if not check:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
    if check and stale:
        sys.exit(f"stale: {', '.join(stale)}; run python -m tb.vectors.figures")


if __name__ == "__main__":
    main()
