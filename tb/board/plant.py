# SPDX-License-Identifier: BSD-2-Clause
"""``plant.toml`` to the ``name=value`` text that the board model reads.

On the command line, for builds that have no Python at run time::

    python -m tb.board.plant speed_scale=0.5 x.mechanical_time_constant_ms*=2 > plant.txt

An override is ``[axis.]name=value`` or ``[axis.]name*=factor``, the axis one of x, y, z, f; without an axis it
holds for all four, whatever the file says of each.
"""

import argparse
import sys
import tomllib
from pathlib import Path

AXES = ("x", "y", "z", "f")
DEFAULT_FILE = Path(__file__).with_name("plant.toml")


def load(overrides=(), path=DEFAULT_FILE):
    """Every parameter by its full name (``plant_step_ns``, ``x.pitch_mm``, ...), overrides applied in order.

    Raises :exc:`ValueError` for an override that is malformed or names no parameter of the file.
    """
    with open(path, "rb") as file:
        document = tomllib.load(file)
    parameters = {name: value for name, value in document.items() if not isinstance(value, dict)}
    for axis in AXES:
        own = document.get("axis", {}).get(axis, {})
        for name, value in {**document["default"], **own}.items():
            parameters[f"{axis}.{name}"] = value
    for override in overrides:
        apply(parameters, override)
    return parameters


def apply(parameters, override):
    """Change ``parameters`` in place as one override says."""
    name, equals, text = override.partition("=")
    scaled = name.endswith("*")
    name = name.removesuffix("*").strip()
    names = [n for n in (name, *(f"{axis}.{name}" for axis in AXES)) if n in parameters]
    if not equals or not names:
        raise ValueError(f"expected [axis.]name=value or [axis.]name*=factor of a plant parameter, not {override!r}")
    value = float(text)
    for name in names:
        parameters[name] = parameters[name] * value if scaled else value


def render(parameters):
    """One ``name=value`` line per parameter; decimal text that reads back as the same double."""
    return "".join(f"{name}={float(value)!r}\n" for name, value in parameters.items())


def main():
    parser = argparse.ArgumentParser(description="Print the board model's parameters.")
    parser.add_argument("overrides", nargs="*", metavar="[axis.]name=value")
    arguments = parser.parse_args()
    try:
        sys.stdout.write(render(load(arguments.overrides)))
    except ValueError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
