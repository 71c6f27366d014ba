# SPDX-License-Identifier: BSD-2-Clause
"""A short soak (``make soak`` is the long one), and that it notices what it is there for."""

import os
import socket

import pytest

from tb.soak.soak import Wrong, pipeline, soak
from tb.soak.stream import Command, Host
from tb.twin.twin import Twin

COMMANDS = 20_000


def test_each_of_twenty_thousand_commands_is_answered_once_and_in_order():
    with Twin(speed=20) as twin, socket.create_connection(("127.0.0.1", twin.tcp_port)) as line:
        figures = soak(line, COMMANDS, seed=int(os.environ.get("SEED", "1")))
    print(figures)
    assert figures.commands == COMMANDS


class Fake:
    """A line on which ``n`` is answered with ``n``; ``meddle`` has the answers in its hands first."""

    def __init__(self, meddle):
        self.meddle, self.waiting, self.rest = meddle, [], b""

    def send(self, data):
        self.waiting += data.split(b"\r")[:-1]

    def replies(self):
        if not self.waiting:
            raise Wrong("nothing")
        replies, self.waiting = self.waiting, []
        return self.meddle(replies)


def swapped(replies):
    return replies[:10] + [replies[11], replies[10]] + replies[12:]


@pytest.mark.parametrize("meddle, said", [
    (lambda replies: replies[:10] + replies[11:], "command 11, b'10.r', gives b'11'"),
    (lambda replies: replies[:-1], "nothing"),
    (lambda replies: replies[:10] + replies[9:], "command 11, b'10.r', gives b'9'"),
    (lambda replies: [*replies, b":A "], "b':A ', and nothing was asked"),
    (swapped, "command 11, b'10.r', gives b'11'"),
    (lambda replies: [b"x" * (n == 5) + reply for n, reply in enumerate(replies)], "command 6, b'5.r', gives b'x5'"),
])
def test_a_reply_too_few_too_many_or_out_of_turn_is_noticed(meddle, said):
    def commands():
        return iter([Command(f"{n}\r".encode(), str(n)) for n in range(100)])
    pipeline(Fake(lambda replies: replies), commands())
    with pytest.raises(Wrong, match=said):
        pipeline(Fake(meddle), commands())


def test_positions_are_judged_by_their_form_and_f_must_not_go_back():
    host = Host(1)
    check = host.places("XF")
    assert check(":A 12.0 -300.5 ") is None
    assert check(":A 12.0 -300.0 ") is None
    assert "before" in check(":A 12.0 -302.0 ")
    assert "expected 2 positions with 1 decimals" in check(":A 12.0 -300 ")
    assert "no command" in check(":A 90000.0 -299.0 ")
