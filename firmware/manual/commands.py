# SPDX-License-Identifier: BSD-2-Clause
"""``python -m firmware.manual.commands``: docs/commands.md from the rows of the firmware (``--check``: is it up to date?).

The rows are printed by a program made of the firmware's own tables (``rows.c``).
"""

import argparse
import json
import subprocess
from pathlib import Path

from tb.firmware.host import build

__all__ = ["render", "rows"]

PAGE = Path(__file__).resolve().parents[2] / "docs" / "commands.md"

FORMS = {0: ":A X=1 Y=2", 1: ":X=1 Y=2 A", 2: "X=1 :A", 3: ":A 1 2 ", 4: ":A 1 2"}
OUTSIDE = {0: "", 1: "clipped", 2: "ignored"}
SAVED = {0: "SS", 1: "at once", 2: "never"}

HEAD = """\
# Commands

Generated from the rows of the firmware by `python -m firmware.manual.commands`; do not edit.

## Lines and replies

A command is a line ended by CR: a name or its shortcut, then arguments. Case does not matter, nor do blanks between
arguments. An empty line gets no answer; every other line gets exactly one.

| Argument | Means |
|---|---|
| `X` | the axis or parameter X; 0 where a number is wanted |
| `X=1.5` | set; exponents are understood (`1.5e-3`); letters before the X of the same word are ignored (`VX=1.5`) |
| `X?` | query; sets and queries may stand in one line, and the queries are answered after the sets |
| `X+` `X-` | as the parameter says: here and default, on and off, count |
| `XYZ` | `X Y Z` |

Values come in the order of the hardware's axes, whatever the order asked. A command that answers no values answers
`:A` and a blank. The form of a query's answer differs from command to command, and hosts depend on it. `:A 1 2 `
ends in a blank. Inner lines of a long answer end in CR alone, the last line of every answer in CR LF.

| Error | Means |
|---|---|
| `:N-1` | no such command, or its module is not built |
| `:N-3` | an argument, its letter or its number is missing |
| `:N-2` | the command has no such letter, or the axis is not fitted |
| `:N-4` | a value out of its range, or a form of argument that the letter does not take |
| `:N-5` | correct, but it could not be done now |
| `:N-6` | a stray character, a line over 128 characters, or more than 32 arguments |
| `:N-21` | to HALT: it stopped a commanded motion |

The first that applies, from the top, is the answer, and then nothing of the line has been done.

Backspace, Del and Esc drop the line typed so far and the lines that wait. `\\` as the first character of a line stops
everything at once, before CR. 255 and one more byte are controls, taken anywhere and without an answer: 65 and 66
choose lines or [frames](#low-level-frames), 72 and 84 one decimal or none in positions, 82 resets.
"""

TAIL = """\
## Low-level frames

Between 255 66 and 255 65 the controller takes binary frames and no lines: the number of the axis (LLADDR), a command,
a size, data, and 58. Places are tenths of a micron, two's complement, least significant byte first, in the
direction of UM. Answers are raw bytes without an end; what is not in the table is taken and ignored.

| Command | Size | Data | Answer | Does |
|---|---|---|---|---|
| `?` 63 | 0 | | `B` 66 or `b` 98 | busy or not |
| `T` 84 | 1 to 4 | place | | moves there |
| `a` 97 | 3 | | 3 bytes | place |
| `l` 108 | 3 | | 4 bytes | place, and the byte of RDSTAT |
| `~` 126 | 1 | | 1 byte | the byte of RDSTAT |
| `D` 68 | 1 to 4 | distance | | sets the increment |
| `d` 100 | 3 | | 3 bytes | the increment |
| `+` 43, `-` 45 | 0 | | | moves by the increment |
| `G` 71 | 0 | | | enables the axis, as MC + |
| `B` 66 | 0 | | | stops the axis |
| `J` 74, `K` 75 | 0 | | | connects and disconnects the joystick |

24 84 3 160 134 1 58 moves X to 10 mm. A size byte is at most 4; bytes that are no frame are dropped one by one.
"""


def rows(binary=None):
    """The modules, as ``rows.c`` prints them."""
    return json.loads(subprocess.run([binary or build("host/rows")], capture_output=True, text=True, check=True).stdout)


def number(value):
    return f"{value:.12g}"


def cell(text):
    return text.replace("|", "\\|")


def parameter_line(row):
    letter = "axis" if row["letter"] == "*" else row["letter"]
    limits = [OUTSIDE[row[side]] for side in ("below", "above")]
    low, high = (number(row[side]) + (f" ({said})" if said else "")
                 for side, said in zip(("minimum", "maximum"), limits))
    initial = ", ".join(number(value) for value in dict.fromkeys(row["initial"]))
    if row["read_only"]:
        bounds = initial = "–"
    else:
        bounds = low if low == high else f"{low} … {high}"
        if row["taken"] is not None:
            bounds = row["taken"].replace("...", "…") or "–"
    kept = "–" if row["read_only"] else SAVED[row["saved"]]
    return f"| {letter} | {cell(row['summary'])} | {cell(row['unit'])} | {bounds} | {initial} | {kept} |"


def render(modules):
    """Markdown text of the page."""
    parameters = [row for module in modules for row in module["parameters"]]
    commands = sorted(((row, module) for module in modules for row in module["commands"]), key=lambda c: c[0]["name"])
    lines = [HEAD, "## All commands", "", "| Command | Shortcut | What |", "|---|---|---|"]
    for row, _ in commands:
        short = f"`{row['shortcut']}`" if row["shortcut"] else ""
        lines.append(f"| [{row['name']}](#{row['name'].lower()}) | {short} | {cell(row['summary'])} |")
    for row, module in commands:
        lines += ["", f"### {row['name']}", "", row["summary"]]
        own = [p for p in parameters if p["command"] == row["name"] and (p["letter"].isalpha() or p["letter"] == "*")]
        if any(p["asked"] for p in own):
            lines[-1] += f" Queries: `{FORMS[row['form']]}`."
        if own:
            lines += ["", "| Letter | What | Unit | Range | Default | Saved |", "|---|---|---|---|---|---|"]
            lines += [parameter_line(p) for p in own]
    return "\n".join([*lines, "", TAIL])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; fail if the page is not of these rows")
    arguments = parser.parse_args()
    text = render(rows())
    if PAGE.exists() and PAGE.read_text() == text:
        return
    if arguments.check:
        raise SystemExit("docs/commands.md is not of these rows: run python -m firmware.manual.commands")
    PAGE.write_text(text)


if __name__ == "__main__":
    main()
