# SPDX-License-Identifier: BSD-2-Clause
"""The host's end of the serial line: one command, one reply."""

from __future__ import annotations

US, MS, S = 10**6, 10**9, 10**12                             # picoseconds


class ReplyError(Exception):
    """The controller did not answer as it should; the message has the command and the reply."""


class ScanRefused(RuntimeError):
    """The controller does not take the line; there is nothing to measure."""


class Console:
    """Send commands and check replies, letting simulated time pass meanwhile.

    Parameters
    ----------
    sim : Simulator
    advance : callable
        ``advance(duration_ps)`` lets time pass: the session's, so that records and progress go on.
    say : callable
        Takes one line of transcript.
    """

    REPLY_TIMEOUT_PS = 200 * MS
    STEP_PS = 500 * US

    def __init__(self, sim, advance, say):
        self._sim, self._advance, self._say = sim, advance, say
        self._received = b""

    def wait_until_up(self):
        """Ask for the status until the controller answers; what is sent before it runs is lost."""
        for _ in range(50):
            self._sim.serial_write(b"/\r")
            if self._line(20 * MS) is not None:
                self._advance(20 * MS)                       # a second answer may be under way
                self._take()
                self._received = b""
                return
        raise ReplyError("no answer to / within a second of power-up")

    def ask(self, command: str, quiet=False) -> str:
        """Send one command; return its reply without the line end."""
        sent_ps = self._sim.time_ps
        self._sim.serial_write(command.encode("ascii") + b"\r")
        reply = self._line(self.REPLY_TIMEOUT_PS)
        if reply is None:
            raise ReplyError(f"no reply to {command!r} within {self.REPLY_TIMEOUT_PS / MS:g} ms")
        if not quiet:
            self._say(f"{sent_ps / S:8.3f} s  > {command:<28} < {reply}")
        return reply

    def order(self, command: str):
        """Send a command that must be acknowledged."""
        reply = self.ask(command)
        if not reply.startswith(":A"):
            raise ReplyError(f"{command!r} was answered {reply!r}")

    def busy(self) -> bool:
        """Whether the controller still works on a command."""
        reply = self.ask("/", quiet=True)
        if reply not in ("B", "N"):
            raise ReplyError(f"'/' was answered {reply!r}")
        return reply == "B"

    def lines(self) -> list[str]:
        """Every whole line received since, for a host that does not wait for each."""
        self._take()
        *whole, self._received = self._received.split(b"\n")
        return [line.decode("latin-1").strip() for line in whole]

    def _take(self):
        self._received += self._sim.serial_read()

    def _line(self, timeout_ps):
        """The next line, or None in time."""
        end_ps = self._sim.time_ps + timeout_ps
        while self._sim.time_ps < end_ps:
            self._take()
            line, feed, rest = self._received.partition(b"\n")
            if feed:
                self._received = rest
                return line.decode("latin-1").strip()
            self._advance(self.STEP_PS)
        return None


class Flood:
    """Position requests without pause, and the check that each is answered once and sensibly."""

    OUTSTANDING = 8                                          # the replies are longer: this keeps the line full

    def __init__(self, sim, console):
        self._sim, self._console = sim, console
        self.sent = self.answered = 0
        self.wrong: list[str] = []

    def step(self, more=True):
        """Take what came and, unless ``more`` is false, fill up."""
        for line in self._console.lines():
            self.answered += 1
            words = line.split()
            if len(words) != 3 or words[0] != ":A" or not all(map(_is_number, words[1:])):
                self.wrong.append(line)
        while more and self.sent - self.answered < self.OUTSTANDING:
            self._sim.serial_write(b"W X Y\r")
            self.sent += 1

    def done(self) -> bool:
        return self.answered >= self.sent


def _is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True
