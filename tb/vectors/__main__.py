# SPDX-License-Identifier: BSD-2-Clause
"""``python -m tb.vectors [folder]``: draw the scenario tables as figures of the manual (docs/figures by default).

A figure shows what the tests of the same table assert; equal tables give equal files.
"""

import argparse
from pathlib import Path

import matplotlib

from tb.vectors import OUTPUTS, load

BLOCKS = ("compare", "divider", "router")
LEVELS = ("sync", "encoder", "out0", "armed", "late")


def positions(scenario, axis, start):
    """Count of an axis in each clock."""
    count, result = start, []
    for clock in range(scenario.clocks):
        count += scenario.inputs.get(clock, {}).get(f"step{axis}", 0)
        result.append(count)
    return result


def numbers(axes, row, values):
    """A row of numbers, each written where it begins."""
    for clock, value in enumerate(values):
        if clock == 0 or value != values[clock - 1]:
            axes.plot([clock, clock], [row, row + 0.7], color="0.7", linewidth=0.6)
            axes.text(clock + 0.15, row + 0.12, str(value), fontsize=6)


def draw(scenario, path):
    """One scenario: positions and strobes above, outputs below, one clock per column."""
    import matplotlib.pyplot as plt
    rows = [("position X", positions(scenario, 0, scenario.setup["start"]))]
    if any("step1" in given for given in scenario.inputs.values()):
        rows.append(("position Y", positions(scenario, 1, scenario.setup["start_y"])))
    for strobe in ("arm", "disarm"):
        if any(strobe in given for given in scenario.inputs.values()):
            rows.append((strobe, [int(strobe in scenario.inputs.get(n, {})) for n in range(scenario.clocks)]))
    rows += [(name, scenario.outputs[name]) for name in OUTPUTS if name in scenario.outputs]

    figure, axes = plt.subplots(figsize=(8, 0.35 * len(rows) + 0.9))
    for n, (name, values) in enumerate(rows):
        base = -n
        if name in LEVELS or name in ("arm", "disarm"):
            axes.step(range(scenario.clocks + 1), [base + 0.7 * v for v in [*values, values[-1]]], where="post",
                      color="tab:blue" if name in LEVELS else "tab:red", linewidth=1.2)
        else:
            numbers(axes, base, values)
    axes.set_yticks([0.3 - n for n in range(len(rows))], [name for name, _ in rows], fontsize=7)
    axes.set_xlim(0, scenario.clocks)
    axes.set_xticks(range(0, scenario.clocks + 1, 5))
    axes.tick_params(axis="x", labelsize=7)
    axes.grid(axis="x", color="0.92")
    axes.set_xlabel("fast clocks (5 ns)", fontsize=7)
    axes.set_title(scenario.name, fontsize=8)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(prog="python -m tb.vectors", description="Draw the scenario tables.")
    parser.add_argument("folder", nargs="?", type=Path, default=Path("docs/figures"))
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "tables", "svg.fonttype": "none"})
    for block in BLOCKS:
        for n, scenario in enumerate(load(block), 1):
            draw(scenario, folder / f"{block}-{n}.svg")


if __name__ == "__main__":
    main()
