# SPDX-License-Identifier: BSD-2-Clause
"""Scenario tables: what goes in, what comes out and when.  They are test vectors and the figures of the manual.

A file ``<block>.toml`` is a list of::

    [[scenario]]
    name = "a claim, in words"
    setup = { start = 97, reference = 100, whole = 2 }
    rows = [[2, { arm = 1 }, {}], [5, {}, { armed = 1 }], [8, { position = 105 }, {}]]

A row is a ``fast`` clock, inputs given in it, and outputs from it on.  ``position`` and ``y`` move the X and Y
axis there by one count per clock, the first in the row's clock; ``arm`` and ``disarm`` are strobes; the names of
routes (below) change routes.  Clocks are those of the step streams and of the pins of :class:`rtl.line.ScanLine`.
"""

import dataclasses
import tomllib
from pathlib import Path

__all__ = ["OUTPUTS", "ROUTES", "Scenario", "load"]

SETUP = {
    "start": 0, "start_y": 0, "reference": 0, "reverse": 0, "whole": 1, "fraction": 0, "phase": 0xffffffff,
    "pixels": 1, "width": 1, "emit": 1, "axis": 0, "pixel_axis": 0,
}
"""Setup and defaults: counts; edges; registers of the same name; axes of SYNC and of pixels."""

ROUTES = {"out0": 0, "sync": 2, "encoder": 3, "out0_invert": 0, "sync_invert": 0, "encoder_invert": 0}
"""Routes and defaults: source of each pin, and its polarity."""

PINS = ("sync", "encoder", "out0")
REPORTS = ("armed", "late", "produced", "end_position", "merged")
OUTPUTS = PINS + REPORTS
"""Pins, which every scenario checks, and registers, which it checks if it names them."""

INPUTS = {"position", "y", "arm", "disarm", *ROUTES}


@dataclasses.dataclass
class Scenario:
    """``inputs``: {clock: {name: value}}, with ``step0`` and ``step1`` (+1 or -1) in place of positions.

    ``outputs``: {name: [value in clock 0, 1, ...]} for ``clocks`` clocks.
    """
    name: str
    setup: dict
    routes: dict
    clocks: int
    inputs: dict
    outputs: dict


def _checked(names, known, where):
    if unknown := set(names) - set(known):
        raise ValueError(f"{where}: unknown {', '.join(sorted(unknown))}; known are {', '.join(sorted(known))}")


def _scenario(raw):
    name, rows = raw["name"], sorted(raw["rows"], key=lambda row: row[0])
    _checked(raw, {"name", "setup", "rows"}, name)
    _checked(raw["setup"], {**SETUP, **ROUTES}, name)
    setup = {key: raw["setup"].get(key, default) for key, default in SETUP.items()}
    routes = {key: raw["setup"].get(key, default) for key, default in ROUTES.items()}

    inputs, position, free = {}, [setup["start"], setup["start_y"]], [0, 0]
    for clock, given, _ in rows:
        _checked(given, INPUTS, name)
        for key, value in given.items():
            if key not in ("position", "y"):
                inputs.setdefault(clock, {})[key] = value
                continue
            axis = int(key == "y")
            if clock < free[axis]:
                raise ValueError(f"{name}: in clock {clock} the stage is still moving")
            step = 1 if value > position[axis] else -1
            for n in range(abs(value - position[axis])):
                inputs.setdefault(clock + n, {})[f"step{axis}"] = step
            free[axis], position[axis] = clock + abs(value - position[axis]), value

    clocks = max([clock for clock, *_ in rows] + list(inputs)) + 20
    outputs = {key: [0] * clocks for key in OUTPUTS if key in PINS or any(key in row[2] for row in rows)}
    for clock, _, expected in rows:
        _checked(expected, OUTPUTS, name)
        for key, value in expected.items():
            outputs[key][clock:] = [value] * (clocks - clock)
    return Scenario(name, setup, routes, clocks, inputs, outputs)


def load(block):
    """The scenarios of ``<block>.toml``."""
    path = Path(__file__).parent / f"{block}.toml"
    return [_scenario(raw) for raw in tomllib.loads(path.read_text())["scenario"]]
