# SPDX-License-Identifier: BSD-2-Clause
"""Transcripts: what is sent to a controller and what must come back, with the conditions for it, as text.

One thing a line:

==================== ===========================================================================================
``> text``            send the text and a CR; begins an exchange
``$ 18 61 03 3a``     send these bytes and nothing else; begins an exchange
``< text``            a line of the reply, exact but for blanks at its end
``~ regex``           a line of the reply, matched as a whole without the blanks at its end
``...``               any further lines of this reply
``= 3a 8a 0d 0a``     the whole reply, byte for byte
``= nothing``         no reply
``# text``            a comment
==================== ===========================================================================================

Inner lines of a reply end in CR, the last in CR LF. An exchange without a reply line expects silence, as
``= nothing`` does. Conditions make the state that the next exchanges need, and are no exchanges themselves:

======================= ========================================================================================
``! axes X Y Z``         the controller has these axes, else the rest of the file does not apply
``! module NAME``        what follows belongs to a module; if it is not built (manifest) it waits. Bare ``! module``
                         ends it
``! idle``               wait until STATUS says N
``! send text``          send it, expecting ``:A``
``! reset``              RESET, wait until it is over, then wait until STATUS says N
``! wait 200``           let this many milliseconds pass
``! restarting``         the command before has restarted the controller: wait until it answers
======================= ========================================================================================
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

__all__ = ["Condition", "Exchange", "TranscriptError", "parse", "variants"]


class TranscriptError(ValueError):
    """A line that is none of the above."""


@dataclass
class Condition:
    line: int
    name: str
    argument: str


@dataclass
class Exchange:
    """``sent`` as bytes, CR included; ``lines`` are (exact, text) pairs, ``raw`` the whole reply instead."""
    line: int
    text: str
    sent: bytes
    lines: list = field(default_factory=list)
    open_ended: bool = False
    raw: bytes = None

    @property
    def silent(self):
        return self.raw == b"" or not (self.lines or self.open_ended or self.raw)

    def fault(self, reply):
        """What is wrong with a reply, as a sentence; None: nothing."""
        if self.raw is not None:
            return None if reply == self.raw else f"expected the bytes {self.raw.hex(' ') or 'none'}"
        if self.silent:
            return None if not reply else "expected no reply"
        if not reply.endswith(b"\r\n") or b"\n" in reply[:-1]:
            return "expected one reply, ended by CR LF"
        got = [line.rstrip(" ") for line in reply[:-2].decode("latin-1").split("\r")]
        for n, (exact, text) in enumerate(self.lines):
            if n >= len(got):
                return f"expected a line {text!r} more"
            if (got[n] != text) if exact else not re.fullmatch(text, got[n]):
                return f"expected {'' if exact else 'a match of '}{text!r}, not {got[n]!r}"
        if len(got) > len(self.lines) and not self.open_ended:
            return f"expected no line {got[len(self.lines)]!r}"
        return None


CONDITIONS = {"axes", "module", "idle", "send", "reset", "wait", "restarting"}


def parse(text, name="transcript"):
    """The conditions and exchanges of a transcript, in order."""
    steps = []
    for number, line in enumerate(text.splitlines(), 1):
        mark, _, rest = line.partition(" ")
        last = steps[-1] if steps and isinstance(steps[-1], Exchange) else None
        if not line.strip() or mark == "#":
            continue
        if mark == "!" and rest.split()[0] in CONDITIONS:
            condition, _, argument = rest.partition(" ")
            steps.append(Condition(number, condition, argument.strip()))
        elif mark == ">":
            steps.append(Exchange(number, rest, rest.encode("latin-1") + b"\r"))
        elif mark == "$":
            steps.append(Exchange(number, line, bytes.fromhex(rest)))
        elif last and mark in ("<", "~"):
            last.lines.append((mark == "<", rest if mark == "<" else rest.removeprefix("^").removesuffix("$")))
        elif last and line == "...":
            last.open_ended = True
        elif last and mark == "=":
            last.raw = b"" if rest == "nothing" else bytes.fromhex(rest)
        else:
            raise TranscriptError(f"{name}:{number}: expected a line of a transcript, not {line!r}")
    return steps


def load(path):
    return parse(Path(path).read_text(), Path(path).name)


# --- The same words as other hosts would say them ------------------------------------------------------------

def with_exponents(line):
    """``X=12.5`` as ``X=125e-01``."""
    return re.sub(r"(?<==)-?\d*\.?\d+", lambda number: exponent(number[0]), line)


def exponent(number):
    sign, digits = ("-", number[1:]) if number.startswith("-") else ("", number)
    whole, _, fraction = digits.partition(".")
    return f"{sign}{whole}{fraction}e-{len(fraction):02d}" if fraction else f"{sign}{whole}e+00"


def glued(line):
    """``M X=1 Y=2`` as ``M X=1Y=2``: no blank between arguments, but for one before a number alone."""
    if '"' in line:
        return line
    verb, blank, arguments = line.strip().partition(" ")
    return verb + blank + re.sub(r" +(?=[A-Za-z])", "", arguments)


VARIANTS = {"exponents": with_exponents, "glued": glued}


def variants(steps, names):
    """The exchanges with their commands rewritten; ``doubled`` sends every CR twice."""
    for step in steps:
        if isinstance(step, Exchange) and step.sent == step.text.encode("latin-1") + b"\r":
            text = step.text
            for name in names:
                text = VARIANTS.get(name, lambda line: line)(text)
            end = b"\r\r" if "doubled" in names else b"\r"
            step = Exchange(step.line, text, text.encode("latin-1") + end, step.lines, step.open_ended, step.raw)
        yield step
