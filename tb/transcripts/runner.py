# SPDX-License-Identifier: BSD-2-Clause
"""Transcripts against a serial port: one exchange at a time, as a careful host would.

An exchange passes when the whole reply came within ``patience`` seconds and nothing came behind it.
"""

import time
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

from tb.transcripts.transcript import Condition, load, variants

VECTORS = Path(__file__).resolve().parents[1] / "vectors" / "transcripts"
MANIFEST = VECTORS / "manifest.toml"
MIRROR = "UM X=-10000 Y=10000"
IDLE_S = 60


class Deaf(Exception):
    """The controller does not do what a condition needs."""


@dataclass
class Result:
    """``deferred`` are (file:line, module) of exchanges whose module is not built."""
    passed: int = 0
    failures: list = field(default_factory=list)
    deferred: list = field(default_factory=list)
    inapplicable: int = 0

    def __str__(self):
        return f"{self.passed} passed, {len(self.failures)} failed"


class Host:
    """A controller behind an open pyserial port.

    ``patience`` is how long a reply may take, ``quiet`` how long silence is listened to, in seconds of ``clock``.
    """

    def __init__(self, port, *, patience=2.0, quiet=0.02, clock=time.monotonic):
        self._port, self._patience, self._quiet, self._clock = port, patience, quiet, clock
        port.timeout = quiet

    def listen(self, seconds):
        """All bytes of that time."""
        end, data = self._clock() + seconds, b""
        while (left := end - self._clock()) > 0:
            self._port.timeout = min(left, self._quiet)
            data += self._port.read(4096)
        return data

    def ask(self, data, *, complete=lambda reply: reply.endswith(b"\n"), silent=False):
        """Send bytes; the reply, and whatever comes right behind it."""
        self._port.reset_input_buffer()
        self._port.write(data)
        reply, end = b"", self._clock() + (self._quiet if silent else self._patience)
        while self._clock() < end and not complete(reply):
            self._port.timeout = min(self._quiet, max(0, end - self._clock()))
            reply += self._port.read(max(1, self._port.in_waiting))
        return reply + (self._port.read(4096) if self._port.in_waiting else b"")

    def say(self, line):
        """The reply to a line, as text without its end."""
        return self.ask(line.encode("latin-1") + b"\r").decode("latin-1").rstrip(" \r\n")

    def wait_until_idle(self):
        end = self._clock() + max(IDLE_S, 5 * self._patience)
        while (said := self.say("/")) != "N":
            if self._clock() > end:
                raise Deaf(f"STATUS says {said!r} and not N")

    def wait_until_back(self):
        """After a restart: until it answers again; commands of the meantime may be lost."""
        end = self._clock() + max(5, 2 * self._patience)
        while self.say("/") not in ("N", "B"):
            if self._clock() > end:
                raise Deaf("no answer after a restart")
        self.listen(self._quiet)


class Session:
    """A run over some files on one :class:`Host`."""

    def __init__(self, host, *, names=(), manifest=MANIFEST, say=lambda line: None):
        self._host, self._names, self._say = host, tuple(names), say
        self._modules = tomllib.loads(Path(manifest).read_text())["module"]
        self._built = {}
        self.result = Result()

    def run(self, path):
        path = Path(path)
        module, applies = None, True
        self._begin()
        for step in variants(load(path), [n for n in self._names if n != "mirrored"]):
            place = f"{path.name}:{step.line}"
            if isinstance(step, Condition):
                if step.name == "module":
                    module = step.argument or None
                elif step.name == "axes":
                    applies = self._has_axes(step.argument.split())
                elif applies and self.is_built(module):
                    self._meet(step, place)
            elif not applies:
                self.result.inapplicable += 1
            elif not self.is_built(module):
                self.result.deferred.append((place, module))
            else:
                self._exchange(step, place)

    def is_built(self, module):
        """Whether the controller knows the probe command of a module of the manifest."""
        if module is None:
            return True
        if module not in self._built:
            self._built[module] = self._host.say(self._modules[module]["probe"]) != ":N-1"
        return self._built[module]

    def _begin(self):
        self._host.wait_until_back()
        self._host.say("HALT")
        self._host.wait_until_idle()
        for line in (["UM X=10000 Y=10000", "Z"] if "mirrored" not in self._names else [MIRROR, "Z"]):
            if (said := self._host.say(line)) != ":A":
                self.result.failures.append(f"{line}: {said!r}")

    def _has_axes(self, letters):
        reply = self._host.say("BU X")
        line = next((line for line in reply.split("\r") if line.startswith("Motor Axes: ")), "")
        return set(letters) <= set(line.split()[2:])

    def _meet(self, step, place):
        try:
            self._do(step)
        except Deaf as why:
            self.result.failures.append(f"{place}: ! {step.name}: {why}")

    def _do(self, step):
        host = self._host
        if step.name == "idle":
            host.wait_until_idle()
        elif step.name == "wait":
            host.listen(float(step.argument) / 1e3)
        elif step.name == "restarting":
            host.wait_until_back()
        elif step.name == "reset":
            if (said := host.say("RESET")) != ":A":
                raise Deaf(f"RESET gives {said!r}")
            host.wait_until_back()
            host.wait_until_idle()
        elif (said := host.say(step.argument)) != ":A":
            raise Deaf(f"{step.argument} gives {said!r}")

    def _exchange(self, step, place):
        raw = step.raw
        complete = {} if raw is None else {"complete": lambda reply: len(reply) >= len(raw)}
        reply = self._host.ask(step.sent, silent=step.silent, **({} if step.silent else complete))
        fault = step.fault(reply)
        if fault is None:
            self.result.passed += 1
        else:
            self.result.failures.append(f"{place}: {step.text}: {fault}; the reply was {reply!r}")
            self._say(self.result.failures[-1])
