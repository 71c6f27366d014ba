# SPDX-License-Identifier: BSD-2-Clause
"""Read channels from a value change dump (IEEE 1364-2005, section 18.2), in one pass.

About 2 million changes a second; a dump with many other signals is fine, only the named ones are kept.
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

from .capture import Capture, CaptureError, Trace, choose

UNIT_PS = {b"s": 10**12, b"ms": 10**9, b"us": 10**6, b"ns": 10**3, b"ps": 1, b"fs": Fraction(1, 1000)}


def read_vcd(path: Path, wanted: list[str]) -> Capture:
    """Read the channels ``wanted``; a bit of a vector is asked for as ``name[bit]``.

    Through an unknown or floating level the last known one holds. An unfinished last line is left out
    and reported.
    """
    with open(path, "rb") as file:
        try:
            scale_ps, variables = _header(file, path)
        except (ValueError, IndexError) as error:
            raise CaptureError(f"{path}: header not understood: {error}") from None
        selected = {name: _find(variables, name) for name in wanted}
        watched: dict[bytes, list] = {}
        changes = {name: ([], []) for name in wanted}
        for name, (code, bit) in selected.items():
            watched.setdefault(code, []).append((bit, *changes[name]))
        try:
            end, cut_short = _body(file, watched)
        except ValueError as error:
            raise CaptureError(f"{path}: a line is not understood: {error}") from None
    traces = {
        name: Trace.from_changes([int(t * scale_ps) for t in times] if scale_ps != 1 else times, levels)
        for name, (times, levels) in changes.items()
    }
    return Capture(traces, int(end * scale_ps), cut_short)


def _header(file, path):
    """Parse up to $enddefinitions; return picoseconds per time unit and {full name: (code, msb, lsb)}."""
    scale_ps, variables, scope, words = None, {}, [], []
    for line in file:
        words += line.split()
        while b"$end" in words:
            stop = words.index(b"$end")
            section, words = words[:stop], words[stop + 1:]
            keyword = section[0] if section else b""
            if keyword == b"$timescale":
                found = re.fullmatch(rb"(1|10|100)([munpf]?s)", b"".join(section[1:]))
                if not found:
                    raise CaptureError(f"{path}: time scale not understood: {b' '.join(section[1:])!r}")
                scale_ps = int(found[1]) * UNIT_PS[found[2]]
            elif keyword == b"$scope":
                scope.append(section[2].decode())
            elif keyword == b"$upscope":
                scope.pop()
            elif keyword == b"$var":
                _declare(variables, scope, section)
            elif keyword == b"$enddefinitions":
                if scale_ps is None:
                    raise CaptureError(f"{path}: no $timescale before $enddefinitions")
                return scale_ps, variables
    raise CaptureError(f"{path}: not a value change dump (no $enddefinitions)")


def _declare(variables, scope, section):
    """Enter ``$var type size code name [msb:lsb]``; the range may be glued to the name."""
    size, code, name = int(section[2]), section[3], b"".join(section[4:]).decode()
    found = re.fullmatch(r"(.*)\[(\d+):(\d+)\]", name)
    if found:
        name, msb, lsb = found[1], int(found[2]), int(found[3])
    else:
        msb, lsb = size - 1, 0
    variables[".".join([*scope, name])] = (code, msb, lsb)


def _find(variables, wanted):
    """Code and bit (None for a scalar) of the wanted channel."""
    found = re.fullmatch(r"(.*)\[(\d+)\]", wanted)
    names = list(variables)
    if found and not any(name.rsplit(".", 1)[-1] == wanted or name == wanted for name in names):
        code, msb, lsb = variables[choose(names, found[1])]
        bit = int(found[2])
        if not min(msb, lsb) <= bit <= max(msb, lsb):
            raise CaptureError(f"channel {wanted!r}: bit outside [{msb}:{lsb}]")
        return code, abs(bit - lsb)
    code, msb, lsb = variables[choose(names, wanted)]
    if msb != lsb:
        raise CaptureError(f"channel {wanted!r} has {abs(msb - lsb) + 1} bits; name one, as {wanted}[{lsb}]")
    return code, None


def _body(file, watched):
    """Collect changes of the watched codes; return the last time and whether the file ends mid-line."""
    time, previous, cut_short, one = 0, 0, False, ord("1")
    for line in file:
        kind = line[0]
        if kind == 35:                                       # '#': a time
            if line[-1] != 10:
                cut_short = True
                break
            time = int(line[1:])
            if time < previous:
                raise CaptureError(f"time goes backwards: #{time} after #{previous}")
            previous = time
        elif kind in b"01":
            if line[-1] != 10:
                cut_short = True
                break
            for _, times, levels in watched.get(line[1:].strip(), ()):
                times.append(time)
                levels.append(kind == one)
        elif kind in b"bB":
            if line[-1] != 10:
                cut_short = True
                break
            value, code = line[1:].split()
            for bit, times, levels in watched.get(code, ()):
                # A value shorter than its vector is extended with 0, or with x or z where it starts so.
                padded = value.rjust(1 + (bit or 0), b"0" if value[:1] in b"01" else b"x")
                level = padded[len(padded) - 1 - (bit or 0)]
                if level in b"01":
                    times.append(time)
                    levels.append(level == one)
    return time, cut_short
