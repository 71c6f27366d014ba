# SPDX-License-Identifier: BSD-2-Clause
"""Commands without a pause into a controller's serial line, and the judgement of what comes back.

A round: all axes at rest at known places; F begins to creep; then commands, pipelined; then HALT, moves to known places,
and a look whether the axes are there.  As many commands are under way as the controller's queue holds (core/console.h), so that
one direction of the line is always busy: which share of it, is measured on the controller's own clock, which is F's way.
"""

import select
import time
from collections import deque
from dataclasses import dataclass

from tb.soak.stream import CREEP_MM_S, DONE, Host

ROUND = 10_000              # commands
WINDOW = 768                # bytes sent and not answered; the controller queues 1024
LINE_BYTES_S = 11520        # 115200 baud
SILENCE_S = 20              # without a byte: something is stuck
START_MM = -40.0
REST = ("PC X=0.00005 Y=0.00005 Z=0.00005", "WT X=0 Y=0 Z=0", "S X=6.8 Y=6.8 Z=6.8 F=6.8")


class Wrong(AssertionError):
    """A reply that is missing, too many, out of turn or not what it must be."""


@dataclass
class Figures:
    commands: int = 0
    sent: int = 0               # bytes
    received: int = 0
    controller_s: float = 0     # while commands are pipelined
    real_s: float = 0

    def __str__(self):
        line = LINE_BYTES_S * self.controller_s
        return (f"{self.commands} commands in {self.real_s:.0f} s, {self.controller_s:.0f} s of the controller's: "
                f"{self.commands / self.controller_s:.0f} a second; line in {100 * self.sent / line:.1f} %, "
                f"out {100 * self.received / line:.1f} %")


class Line:
    """A socket, its replies one by one."""

    def __init__(self, connection):
        self.connection = connection
        self.connection.setblocking(False)
        self.rest = b""
        self.sent = self.received = 0

    def replies(self):
        """All replies that have come, without CR LF; waits for something."""
        ready, _, _ = select.select([self.connection], [], [], SILENCE_S)
        if not ready:
            raise Wrong(f"nothing for {SILENCE_S} s; half a reply: {self.rest!r}")
        data = self.connection.recv(65536)
        if not data:
            raise Wrong("the controller has closed the line")
        self.received += len(data)
        *whole, self.rest = (self.rest + data).split(b"\r\n")
        return whole

    def send(self, data):
        self.sent += len(data)
        self.connection.setblocking(True)
        self.connection.sendall(data)
        self.connection.setblocking(False)

    def ask(self, text):
        self.send(f"{text}\r".encode())
        got = self.replies()
        while not got:
            got = self.replies()
        if len(got) != 1 or self.rest:
            raise Wrong(f"{text!r} gives {got} and {self.rest!r}")
        return got[0].decode()


def pipeline(line, commands):
    """Send commands without a pause, and judge the replies in their order."""
    waiting, under_way, done = deque(), 0, False
    answered = 0
    while not done or waiting:
        batch = []
        while not done and under_way < WINDOW:
            command = next(commands, None)
            if command is None:
                done = True
                break
            batch.append(command.sent)
            waiting.append(command)
            under_way += len(command.sent)
        if batch:
            line.send(b"".join(batch))
        if not waiting:
            break
        for got in line.replies():
            answered += 1
            if not waiting:
                raise Wrong(f"{got!r}, and nothing was asked")
            command = waiting.popleft()
            under_way -= len(command.sent)
            wrong = command.judge(got.decode(errors="replace"))
            if wrong:
                raise Wrong(f"command {answered}, {command.sent!r}, gives {got!r}: {wrong}")
    if line.rest:
        raise Wrong(f"more than was asked for: {line.rest!r}")


def settle(line, *, limit_s=30):
    began = time.monotonic()
    while line.ask("/") != "N":
        if time.monotonic() - began > limit_s:
            raise Wrong(f"busy for {limit_s} s after the last move")
        time.sleep(0.01)


def place(line, axis):
    """Tenths of a micron."""
    return float(line.ask(f"W {axis}").split()[1])


def prepare(line, host):
    """Everything at rest, and F about to creep."""
    for text in REST:
        line.ask(text)
    host.known = {key: value for key, value in host.known.items() if key[0] not in ("PCROS", "WAIT", "SPEED")}
    line.ask(f"M F={START_MM * 1e4:.0f}")
    settle(line)
    host.crept = float("-inf")
    if line.ask(f"VE F={CREEP_MM_S}") != DONE:
        raise Wrong("F does not creep")


def conclude(line, host):
    """Stop, and look whether the axes go where they were last sent."""
    if line.ask("\\") not in (":N-21", DONE):
        raise Wrong("HALT is not acknowledged")
    for text in REST:
        line.ask(text)
    line.ask("M " + " ".join(f"{axis}={host.target[axis]:.1f}" for axis in "XYZ"))
    settle(line)
    for axis in "XYZ":
        found = place(line, axis)
        if abs(found - host.target[axis]) > 1:
            raise Wrong(f"{axis} was sent to {host.target[axis]} and is at {found}")


def soak(connection, count, *, seed=1, progress=lambda figures: None):
    """Send ``count`` commands in rounds; :class:`Figures`, or :exc:`Wrong`."""
    host, line, figures = Host(seed), Line(connection), Figures()
    began = time.monotonic()
    while figures.commands < count:
        number = min(ROUND, count - figures.commands)
        prepare(line, host)
        sent, received = line.sent, line.received
        from_mm = place(line, "F") / 1e4
        pipeline(line, (host.next() for _ in range(number)))
        figures.controller_s += (place(line, "F") / 1e4 - from_mm) / CREEP_MM_S
        figures.commands += number
        figures.sent += line.sent - sent
        figures.received += line.received - received
        figures.real_s = time.monotonic() - began
        conclude(line, host)
        progress(figures)
    return figures
