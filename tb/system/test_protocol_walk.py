# SPDX-License-Identifier: BSD-2-Clause
"""The second walk: from a serial byte to the reply, on the real firmware in the real gateware.

Every request gets exactly one reply, also when it is wrong; a wrong one changes nothing, and the next good one works.
"""

import random

import pytest

from tb.sim.simulator import MS, S

WRONG = {
    "malformed": ("SCANF =0", ":N-1"),
    "unknown command": ("FOO X=1", ":N-1"),
    "missing parameter": ("MOVE", ":N-3"),
    "axis that is not fitted": ("MOVE Q=1", ":N-2"),
    "axis that is not fitted, among good ones": ("MOVE X=100 Q=1", ":N-2"),
    "line too long": ("M X=" + "1" * 296, ":N-6"),
}


def unmoved(sim):
    return sim.command("W X Y Z") == ":A 0.0 0.0 0.0 \r\n" and sim.command("/") == "N\r\n"


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_line_gets_its_error_and_moves_nothing(powered, case):
    line, error = WRONG[case]
    assert powered.command(line) == f"{error}\r\n"
    powered.run(20 * MS)
    assert powered.serial_read() == b"", "more than one reply"
    assert unmoved(powered)


@pytest.mark.parametrize("setting, error", [
    ("SCANR X=0 Y=1 Z=0", ":N-4"), ("SCANR X=0.5 Y=0.5 Z=24", ":N-4"), ("SCANR X=0 Y=0.0001 Z=24", ":N-4"),
])
def test_a_scan_that_cannot_be_is_refused_and_moves_nothing(powered, setting, error):
    replies = [powered.command(line) for line in (setting, "SCANV X=0 Y=1 Z=1", "SCAN")]
    assert f"{error}\r\n" in (replies[0], replies[2]), replies
    assert replies[2] != ":A \r\n" or replies[0] == f"{error}\r\n"
    powered.command("SCAN X=80")
    assert unmoved(powered)


@pytest.mark.parametrize("seed", [29, 44])
def test_random_bytes_do_no_harm(powered, seed):
    """4 kB of anything, then the way back to the command language: CR, 255 65, CR.

    Seed 29 has 255 82 (reset) in it, seed 44 has 255 66 (binary commands): both legal, neither the end.
    """
    noise = random.Random(seed).randbytes(4_000)
    assert b"\xffR" in noise or b"\xffB" in noise
    powered.serial_write(noise + b"\r\xffA\r")
    powered.run_until(lambda: powered.serial_unsent == 0, timeout_ps=2 * S)
    powered.run(100 * MS)
    assert powered.command("V").startswith(":A Version: USB-")
    assert powered.command("HALT").rstrip() in (":A", ":N-21")
    assert powered.command("W X").startswith(":A ")


def test_commands_sent_without_waiting_are_answered_in_order(powered):
    powered.serial_write(b"W X\rFOO\r/\rW X Y\r\rTTL X?\r")
    powered.run_until_lines(5, timeout_ps=100 * MS)
    powered.run(5 * MS)
    assert powered.serial_read() == b":A 0.0 \r\n:N-1\r\nN\r\n:A 0.0 0.0 \r\n:A X=0\r\n"


def test_a_reply_comes_within_a_host_s_patience(powered):
    """clients are used to 20 ms; measured from the end of the CR to the first byte of the reply."""
    worst_ps = 0
    for line in ("/", "W X Y Z F", "V", "S X?", "FOO"):
        powered.serial_read()
        powered.serial_write(line.encode() + b"\r")
        powered.run_until(lambda: powered.serial_unsent == 0, timeout_ps=50 * MS, every_ps=10**7)
        sent_ps = powered.time_ps
        powered.run_until_lines(1, timeout_ps=100 * MS)
        _, times = powered.serial_read_timed()
        worst_ps = max(worst_ps, int(times[0]) - sent_ps)
    assert worst_ps < 5 * MS
