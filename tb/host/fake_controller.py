# SPDX-License-Identifier: BSD-2-Clause
"""A stand-in for the simulated controller, to test the demonstration without one.

It answers commands, moves an ideal stage through a trapezoid and makes SYNC and pixel pulses by
:mod:`tb.host.scope`. Defects can be asked for, which the demonstration must find.
"""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np

from tb.host.scope import Scope
from tb.sim.simulator import CHANGE, SAMPLE, SIGNALS

MS = 10**9
COUNTS_PER_MM = 45396
RUN_UP_COUNTS = 3000                                         # more than the ramp takes at the highest speed used
ACCEL_S = 0.02
RIPPLE_COUNTS, RIPPLE_HZ = 1.5, 211


class FakeController:
    """The part of :class:`tb.sim.simulator.Simulator` that the demonstration uses.

    ``spoil(scope)`` may change the pins of the line before they are shown; ``answers`` replaces replies.
    """

    def __init__(self, spoil=None, answers=None):
        self.time_ps = 0
        self._spoil, self._answers = spoil, answers or {}
        self._incoming, self._outgoing = b"", []
        self._changes, self._motion, self._busy_until_ps = [], None, 0
        self._line = {"axis": "x", "start": 0.0, "stop": 1.0, "n": "24", "speed": 1.0, "mirror": 1}
        self._sample_ps, self._sampled_ps, self._cut_ps = 0, 0, None
        self.received = []

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        pass

    @property
    def clocks(self):
        return self.time_ps // 20_000, self.time_ps // 40_000

    def levels(self):
        return dict.fromkeys(SIGNALS, 0)

    def record(self, *signals):
        pass

    def sample(self, period_ps):
        self._sample_ps = period_ps

    def run(self, duration_ps):
        self.time_ps += duration_ps

    def serial_write(self, data):
        *commands, self._incoming = (self._incoming + data).split(b"\r")
        for command in commands:
            command = command.decode()
            self.received.append(command)
            reply = self._answers.get(command) or self._reply(command)
            self._outgoing.append((self.time_ps + MS, reply.encode() + b"\r\n"))

    def serial_read(self):
        due = b"".join(text for at_ps, text in self._outgoing if at_ps <= self.time_ps)
        self._outgoing = [(at_ps, text) for at_ps, text in self._outgoing if at_ps > self.time_ps]
        return due

    def cut_pwm(self, axes):
        self._cut_ps = self.time_ps

    def changes(self):
        due = [change for change in self._changes if change[0] <= self.time_ps]
        self._changes = self._changes[len(due):]
        if self._cut_ps is not None:                         # an ideal brake: nothing moves any more
            due = [change for change in due if change[0] <= self._cut_ps]
        return np.array(due, dtype=CHANGE)

    def samples(self):
        times = np.arange(self._sampled_ps, self.time_ps, self._sample_ps)
        self._sampled_ps = int(times[-1]) + self._sample_ps if len(times) else self._sampled_ps
        samples = np.zeros(len(times), dtype=SAMPLE)
        samples["time_ps"] = times
        if self._motion:
            axis = "xy".index(self._line["axis"])
            position = np.interp(times, *self._motion)
            samples["position_counts"][:, axis] = position
            samples["speed_counts_per_s"][:, axis] = np.interp(times + 1, *self._motion) - position
            if self._cut_ps is not None:
                samples["speed_counts_per_s"][times > self._cut_ps] = 0
        return samples

    def _reply(self, command):
        line = self._line
        if command == "/":
            return "B" if self.time_ps < self._busy_until_ps else "N"
        if command == "W X Y":
            return ":A 1234.5 -0.1 "
        if found := re.fullmatch(r"SCANR X=(\S+) Y=(\S+) Z=(\S+)", command):
            line.update(start=float(found[1]), stop=float(found[2]), n=found[3])
        elif found := re.fullmatch(r"SPEED ([XY])=(\S+)", command):
            line.update(axis=found[1].lower(), speed=float(found[2]))
        elif found := re.match(r"UM X=(-?)10000 Y=(-?)10000", command):
            line.update(mirror=-1)
        elif command == "SCAN":
            self._scan()
        return ":A "

    def _scan(self):
        """Compute the whole motion and every pin change of it."""
        line = self._line
        start = round(line["start"] * COUNTS_PER_MM) * line["mirror"]
        length = abs(line["stop"] - line["start"]) * COUNTS_PER_MM
        direction = (1 if line["stop"] > line["start"] else -1) * line["mirror"]
        first = start - direction * RUN_UP_COUNTS
        speed = line["speed"] * COUNTS_PER_MM
        # To the run-up point, wait, accelerate, run, stop: position over time.
        seconds = np.arange(0, 2 * ACCEL_S + (length + 2 * RUN_UP_COUNTS) / speed, 1e-5)
        end_s = seconds[-1] - ACCEL_S
        velocity = speed * np.clip(np.minimum(seconds / ACCEL_S, (end_s + ACCEL_S - seconds) / ACCEL_S), 0, 1)
        # The ripple is RIPPLE_COUNTS high in position, and its speed follows from that.
        turns = 2 * np.pi * RIPPLE_HZ
        velocity *= 1 + RIPPLE_COUNTS * turns / speed * np.cos(turns * seconds)
        way = np.concatenate([np.linspace(0.37, first + 0.37, 3000),
                              first + 0.37 + direction * np.cumsum(velocity) * 1e-5])
        times = self.time_ps + 20 * MS + np.arange(len(way)) * 10_000_000
        self._motion = (times.astype(float), way)
        edges = []
        for begin, until in zip(range(0, len(way), 3000), [*range(3000, len(way), 3000), len(way)]):
            part, at = way[max(0, begin - 1):until], times[max(0, begin - 1):until]
            sign = 1 if part[-1] > part[0] else -1
            crossed = np.arange(np.floor(part[0]) + 1, np.floor(part[-1]) + 1) if sign > 0 else \
                np.arange(np.floor(part[0]), np.floor(part[-1]), -1)
            found = np.interp(crossed * sign, part * sign, at.astype(float))
            edges += [(int(t), sign) for t in found]
        pixels = int(Fraction(str(COUNTS_PER_MM)) * abs(Fraction(str(line["stop"])) - Fraction(str(line["start"])))
                     / Fraction(line["n"]))
        n = Fraction(int(Fraction(line["n"]) * 2**32), 2**32)
        scope = Scope(edges, n, pixels, [(start if direction > 0 else start + 1, direction)], width_ps=1_000_000)
        scope.run()
        if self._spoil:
            self._spoil(scope)
        name = {"x_a": f"{line['axis']}_a", "x_b": f"{line['axis']}_b", "sync": "sync", "encoder": "encoder"}
        self._changes = [(time_ps, SIGNALS.index(name[signal]), level) for time_ps, signal, level in scope.changes()]
        self._busy_until_ps = int(times[-1])
