# SPDX-License-Identifier: BSD-2-Clause
"""The interlock and the watchdog from the pins to the answers of the real firmware, and without it."""

import random

import pytest

from tb.sim.simulator import MS, SIGNALS, US

X, Y = 0, 1


def errors(sim):
    """The codes of the error log, newest first."""
    return [int(code) for line in sim.command("DU Y").split("\r") for code in line.split()]


@pytest.mark.parametrize("wires", ["a", "b", "ab"])
def test_a_broken_wire_takes_the_drive_off_within_a_millisecond(powered, wires):
    seed = random.randrange(1 << 32)
    print(f"seed {seed}")
    rng = random.Random(seed)
    assert powered.command("S X=6.8") == ":A \r\n"
    assert powered.command("M X=60000 Y=60000") == ":A \r\n"
    powered.run(60 * MS + rng.randrange(10_000) * 1000 * 20)
    assert powered.speed_counts_per_s(X) > 200_000               # at nine tenths of full drive
    powered.record("x_pwm", "y_pwm")
    broken_ps, at = powered.time_ps, powered.position_counts(X)
    for wire in wires:
        powered.stick_wire(X, wire, rng.randrange(2))
    powered.run(3 * MS)
    changes = powered.changes()
    last, other = (max(changes["time_ps"][changes["signal"] == SIGNALS.index(pin)]) for pin in ("x_pwm", "y_pwm"))
    print(f"off after {(last - broken_ps) / US:.1f} us")
    assert 0 < last - broken_ps < 1 * MS
    assert other - broken_ps > 2 * MS
    powered.run(60 * MS)
    assert powered.speed_counts_per_s(X) == 0 and powered.levels()["motor_enable"]
    print(f"standing after {abs(powered.position_counts(X) - at) / 45396:.4f} mm")
    assert abs(powered.position_counts(X) - at) < 0.06 * 45396
    assert powered.command("RS X- Y-") == ":A D \r\n"
    assert errors(powered)[0] in ((20, 24) if len(wires) == 2 else (20,))
    for wire in wires:
        powered.stick_wire(X, wire, None)
    assert powered.command("\\").startswith(":")
    powered.run(100 * MS)
    assert powered.command("MC X+") == ":A \r\n"
    powered.run(30 * MS)
    assert powered.command("R X=1000") == ":A \r\n"
    powered.run(150 * MS)
    assert powered.command("/") == "N\r\n" and powered.command("MC X?") == ":A 1\r\n"


def test_a_fault_whose_cause_is_there_is_not_taken_back(powered):
    powered.run(20 * MS)
    levels = powered.levels()
    for wire in "ab":
        powered.stick_wire(X, wire, 1 - levels[f"x_{wire}"])
    powered.run(2 * MS)
    assert powered.command("MC X+") == ":N-5\r\n"
    assert powered.command("RS X-") == ":A D\r\n"
    powered.run(15 * MS)
    assert powered.command("MC X+") == ":A \r\n"
    assert powered.command("RS X-") == ":A  \r\n"
