# SPDX-License-Identifier: BSD-2-Clause
"""RESET on the real firmware: acknowledged, then everything as after power-up, whatever the host goes on sending."""

from tb.sim.simulator import MS, S


def test_a_move_sent_right_behind_reset_is_made_after_it(powered):
    assert powered.command("H X=1000") == ":A \r\n"
    powered.serial_write(b"~\rM X=200\r")
    powered.run(200 * MS)
    assert powered.serial_read() == b":A \r\n:A \r\n"
    assert powered.command("/") == "N\r\n"
    assert powered.command("W X") == ":A 200.0 \r\n"


def test_a_scan_is_over_with_reset(powered):
    for line in ("SCANR X=0 Y=0.5 Z=24", "SCAN X=1 Y=0 Z=0", "TTL X=1", "S X=2", "SCAN"):
        assert powered.command(line) == ":A \r\n"
    powered.run_until(lambda: powered.levels()["sync"] == 1, timeout_ps=1 * S)
    assert powered.command("~") == ":A \r\n"
    powered.run(40 * MS)
    assert powered.levels()["sync"] == 0
    assert powered.command("SCAN X?") == ":A I\r\n"
    assert powered.command("/") == "N\r\n"
