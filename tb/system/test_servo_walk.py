# SPDX-License-Identifier: BSD-2-Clause
"""The first walk: from the encoder pin to the motor pin, on the real firmware in the real gateware."""

import numpy as np
import pytest

from tb.sim.simulator import MS, S, SIGNALS, US

COUNTS_PER_MM = 45396


def wait_until_idle(sim, timeout_ps=2 * S):
    end = sim.time_ps + timeout_ps
    while sim.command("/") != "N\r\n":
        assert sim.time_ps < end, "still busy"
        sim.run(5 * MS)


def true_counts(sim, axis):
    sim.sample(US)
    sim.run(2 * US)
    sim.sample(0)
    return sim.samples()["position_counts"][-1][axis]


@pytest.mark.parametrize("axis", range(4))
def test_a_move_brings_the_stage_to_its_target(powered, axis):
    letter = "XYZF"[axis]
    before = true_counts(powered, axis)
    assert powered.command(f"M {letter}=1000") == ":A \r\n"
    assert powered.command("/") == "B\r\n", "busy before the acknowledge has left"
    wait_until_idle(powered)
    moved = true_counts(powered, axis) - before
    assert moved == pytest.approx(0.1 * COUNTS_PER_MM, abs=2.0)
    assert powered.command(f"W {letter}") in (":A 999.9 \r\n", ":A 1000.0 \r\n", ":A 1000.1 \r\n")


def test_a_move_to_where_the_axis_is_does_not_stay_busy(powered):
    assert powered.command("M X=0") == ":A \r\n"
    powered.run(20 * MS)
    assert powered.command("/") == "N\r\n"


def test_halt_stops_a_move(powered):
    powered.command("M X=100000")
    powered.run(50 * MS)
    assert powered.command("\\") == ":N-21\r\n"
    powered.run(100 * MS)
    assert powered.command("/") == "N\r\n"
    first = true_counts(powered, 0)
    powered.run(50 * MS)
    assert true_counts(powered, 0) == pytest.approx(first, abs=1.0)
    assert first < 9 * COUNTS_PER_MM


def test_the_emergency_stop_takes_the_drive_off_the_pins(powered):
    """No software between the pin and the drive; latency as docs/timing.md states it."""
    powered.command("M X=100000")
    powered.run(50 * MS)
    powered.record("x_pwm", "motor_enable", "estop")
    stop_ps = powered.time_ps + 100 * US
    powered.schedule_input(stop_ps, "estop", 1)
    powered.run(5 * MS)
    changes = powered.changes()
    after = changes[(changes["time_ps"] > stop_ps) & (changes["signal"] == SIGNALS.index("x_pwm"))]
    assert not (after["level"] == 1).any(), "the drive came back"
    assert (after["time_ps"] - stop_ps < 200_000).all(), "later than ten 50 MHz clocks"
    assert powered.levels()["x_pwm"] == 0


def test_the_duty_is_taken_at_one_phase(powered):
    """Pulses of the motor pin lie on a grid of the PWM period, and change on a grid of the servo tick.

    Whatever the firmware does meanwhile: so the time from a snapshot to the drive it causes is constant.
    """
    powered.record("x_pwm")
    powered.command("M X=20000 Y=20000 Z=20000 F=20000")
    for _ in range(10):
        powered.command("W X Y Z F")
    changes = powered.changes()
    rising, falling = (changes["time_ps"][changes["level"] == level] for level in (1, 0))
    falling = falling[falling > rising[0]][:len(rising)]
    rising = rising[:len(falling)]
    assert len(rising) > 100
    assert len(np.unique(rising % (50 * US))) == 1
    width = falling - rising
    changed = (np.diff(width) != 0) & (np.diff(rising) == 50 * US)
    assert changed.sum() > 20
    assert len(np.unique(rising[1:][changed] % (100 * US))) == 1


def test_a_limit_switch_stops_the_axis(built):
    with built.power_up(plant_overrides=("x.limit_upper_mm=0.3",)) as sim:
        sim.run(20 * MS)
        sim.command("M X=20000")
        wait_until_idle(sim)
        sim.run(50 * MS)
        assert true_counts(sim, 0) < 0.5 * COUNTS_PER_MM
        assert sim.command("RS X-").strip() == ":A U"
        sim.command("M X=0")
        wait_until_idle(sim)
        assert sim.command("W X") in (":A 0.0 \r\n", ":A 0.1 \r\n", ":A -0.1 \r\n")
