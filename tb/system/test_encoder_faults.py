# SPDX-License-Identifier: BSD-2-Clause
"""Encoders that cannot be believed, from the pins through the gateware to the answers of the real firmware."""

from tb.sim.simulator import MS

X, Y = 0, 1


def change_both_wires(sim, axis):
    """A and B change at one time, as when a plug is loose."""
    levels = sim.levels()
    for wire in "ab":
        sim.stick_wire(axis, wire, 1 - levels[f"{'xyzf'[axis]}_{wire}"])


def errors(sim):
    """The codes of the error log, newest first."""
    return [int(code) for line in sim.command("DU Y").split("\r") for code in line.split()]


def test_an_illegal_transition_stops_its_axis_and_no_other(powered):
    assert powered.command("M X=20000 Y=20000") == ":A \r\n"
    powered.run(30 * MS)
    assert powered.speed_counts_per_s(X) > 10_000
    change_both_wires(powered, X)
    powered.run(20 * MS)
    assert powered.command("RS X? Y?") == ":A NB\r\n"
    assert powered.command("RS X- Y-") == ":A D \r\n"
    assert powered.command("MC X? Y?") == ":A 0 1\r\n"
    assert errors(powered)[:2] == [24, 0]
    powered.run(20 * MS)
    assert powered.speed_counts_per_s(X) == 0 and powered.speed_counts_per_s(Y) > 50_000
    powered.command("\\")


def test_a_broken_wire_ends_as_a_dead_axis(powered):
    assert powered.command("M X=20000") == ":A \r\n"
    powered.run(30 * MS)
    powered.stick_wire(X, "b", 0)
    powered.run(140 * MS)
    assert powered.command("/") == "N\r\n"
    assert powered.command("RS X-") == ":A D\r\n"
    assert errors(powered)[:2] == [20, 0]
    powered.run(30 * MS)
    assert powered.speed_counts_per_s(X) == 0


def test_a_wire_that_breaks_in_a_scan_line_leaves_the_line_incomplete(powered):
    for line in ("SCANR X=0 Y=1 Z=24", "SPEED X=2.64", "TTL X=1", "SCAN"):
        assert powered.command(line) == ":A \r\n"
    powered.run_until_pin("sync", 1, timeout_ps=500 * MS)
    powered.record("sync", "encoder")
    powered.run(30 * MS)
    powered.stick_wire(X, "b", 0)
    powered.run(200 * MS)
    changes = powered.changes()
    assert powered.command("/") == "N\r\n"
    assert sorted(errors(powered)[:3]) == [0, 20, 86]
    assert not powered.levels()["sync"]
    # About 150 pulses of 1891, and none once the wire was broken but of what still came.
    assert 100 < len(changes) // 2 < 200
