# SPDX-License-Identifier: BSD-2-Clause
"""The motor, its friction and its switches against the closed-form solution of their equations."""

import math

import numpy
import pytest

from tb.board import plant
from tb.board.board import Board

X, Y, Z, F = range(4)
US, MS, S = 10**6, 10**9, 10**12  # ps
STEP_S = 5e-6

PARAMETERS = plant.load()
COUNTS_PER_MM = PARAMETERS["x.counts_per_mm"]
MAXIMUM = PARAMETERS["x.maximum_speed_mm_per_s"] * COUNTS_PER_MM  # counts/s


@pytest.fixture
def make():
    boards = []

    def build(*overrides):
        boards.append(Board(*overrides))
        return boards[-1]
    yield build
    for board in boards:
        board.close()


def from_rest_at_full_drive(t_s, mechanical_s=7e-3, electrical_s=0.5e-3, breakaway=0.15, running=0.10):
    """Position (counts) and speed (counts/s) at ``t_s`` after a full drive was applied to a stage at rest.

    Stiction is decided at the ends of plant steps, as board.h says: the torque first rises alone.
    """
    held_s = STEP_S * math.ceil(-electrical_s * math.log(1 - breakaway) / STEP_S)
    if t_s <= held_s:
        return 0.0, 0.0
    frictionless = 1.1 * MAXIMUM / (1 - running)
    # (torque, w) about its steady state (running, 1 - running) decays along two eigenvectors.
    rates, vectors = numpy.linalg.eig([[-1 / electrical_s, -1 / electrical_s], [1 / mechanical_s, 0]])
    torque = 1 - math.exp(-held_s / electrical_s)
    weights = numpy.linalg.solve(vectors, [torque - running, 0 - (1 - running)])
    decays = numpy.exp(rates * (t_s - held_s))
    speed = (1 - running) + (vectors[1] * weights * decays).sum()
    way = (1 - running) * (t_s - held_s) + (vectors[1] * weights * (decays - 1) / rates).sum()
    return frictionless * way, frictionless * speed


def test_full_drive_reaches_the_free_speed(make):
    board = make()
    board.drive(X, 1.0)
    board.drive(Y, -1.0)
    board.advance(200 * MS)
    assert board.speed_counts_per_s(X) == pytest.approx(1.1 * MAXIMUM, rel=1e-9)
    assert board.speed_counts_per_s(Y) == pytest.approx(-1.1 * MAXIMUM, rel=1e-9)
    assert board.speed_counts_per_s(Z) == 0
    before = board.position_counts(X)
    board.advance(S)
    assert board.position_counts(X) - before == pytest.approx(1.1 * MAXIMUM, rel=1e-9)


@pytest.mark.parametrize("drive", [0.2, 0.5, 0.9])
def test_steady_speed_is_drive_less_running_friction(make, drive):
    board = make()
    board.drive(X, drive)
    board.advance(200 * MS)
    assert board.speed_counts_per_s(X) == pytest.approx(1.1 * MAXIMUM * (drive - 0.10) / 0.90, rel=1e-9)


@pytest.mark.parametrize("t_us", [50, 90, 100, 500, 2000, 7000, 20_000, 100_000])
@pytest.mark.parametrize("scale", [1, 2])
def test_a_step_of_the_drive_gives_the_closed_form_motion(make, t_us, scale):
    board = make(f"mechanical_time_constant_ms*={scale}")
    start = board.position_counts(X)
    board.drive(X, 1.0)
    board.advance(5 * US + t_us * US)  # the drive acts from the next plant step on
    position, speed = from_rest_at_full_drive(t_us * 1e-6, mechanical_s=scale * 7e-3)
    assert board.position_counts(X) - start == pytest.approx(position, abs=1e-3)
    assert board.speed_counts_per_s(X) == pytest.approx(speed, abs=1e-3)


def test_the_stage_takes_its_time_constant_to_two_thirds_of_the_speed(make):
    """The two time constants add up: 63 % of the free speed after about 7 ms, whatever their split."""
    board = make()
    board.drive(X, 1.0)
    board.advance(7 * MS)
    assert 0.58 < board.speed_counts_per_s(X) / (1.1 * MAXIMUM) < 0.66


def test_half_speed_plant(make):
    board = make("speed_scale=0.5")
    board.drive(X, 1.0)
    board.advance(200 * MS)
    assert board.speed_counts_per_s(X) == pytest.approx(0.55 * MAXIMUM, rel=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_friction_holds_below_breakaway_and_lets_go_above(make, sign):
    board = make()
    start = board.position_counts(X)
    board.drive(X, sign * 0.149)
    board.advance(S)
    assert board.position_counts(X) == start
    assert board.speed_counts_per_s(X) == 0
    board.drive(X, sign * 0.151)
    board.advance(100 * MS)
    assert sign * board.speed_counts_per_s(X) > 0.05 * MAXIMUM


def test_a_moving_stage_keeps_moving_on_a_drive_that_would_not_start_it(make):
    board = make()
    board.drive(X, 0.5)
    board.advance(100 * MS)
    board.drive(X, 0.12)
    board.advance(200 * MS)
    assert board.speed_counts_per_s(X) == pytest.approx(1.1 * MAXIMUM * 0.02 / 0.90, rel=1e-6)
    board.drive(X, 0.09)
    board.advance(200 * MS)
    assert board.speed_counts_per_s(X) == 0


def test_without_drive_the_stage_stops_and_stays(make):
    board = make()
    board.drive(X, 1.0)
    board.advance(100 * MS)
    board.drive(X, 0.0)
    board.advance(100 * MS)
    stopped = board.position_counts(X)
    assert board.speed_counts_per_s(X) == 0
    board.advance(S)
    assert board.position_counts(X) == stopped


def test_pwm_is_smoothed_into_torque(make):
    """20 kHz PWM at the pins moves the stage as its mean does, and the last clock of on-time counts."""
    pwm, mean = make(), make()
    on_ps, period_ps = 20_020_000, 50_000_000  # 40.04 %: 1001 of 2500 clocks of 20 ns
    mean.drive(X, on_ps / period_ps)
    for _ in range(4000):
        pwm.drive_pins(pwm=1, dir=1)
        pwm.advance(on_ps)
        pwm.drive_pins(pwm=0, dir=1)
        pwm.advance(period_ps - on_ps)
    mean.advance(4000 * period_ps)
    assert pwm.speed_counts_per_s(X) == pytest.approx(mean.speed_counts_per_s(X), rel=2e-3)
    # The difference of one clock in 2500 in the duty is 0.04 %, of a speed that hangs on (duty - friction).
    expected = 1.1 * MAXIMUM * (0.4004 - 0.10) / 0.90
    before = pwm.position_counts(X)
    pwm.drive_pins(pwm=1, dir=1)
    pwm.advance(on_ps)
    pwm.drive_pins(pwm=0, dir=1)
    pwm.advance(period_ps - on_ps)
    assert pwm.position_counts(X) - before == pytest.approx(expected * 50e-6, rel=1e-4)


def test_pins_choose_direction_and_enable(make):
    board = make()
    board.drive_pins(pwm=0b1011, dir=0b0001)
    board.advance(50 * MS)
    speeds = [board.speed_counts_per_s(axis) for axis in range(4)]
    assert speeds[X] > 0.9 * MAXIMUM and speeds[Y] < -0.9 * MAXIMUM
    assert speeds[Z] == 0 and speeds[F] < -0.9 * MAXIMUM
    board.drive_pins(pwm=0b1011, dir=0b0001, motor_enable=0)
    board.advance(100 * MS)
    assert [board.speed_counts_per_s(axis) for axis in range(4)] == [0, 0, 0, 0]


def test_cut_pwm_wires_stop_the_axis_and_only_that_axis(make):
    board = make()
    board.drive(X, 1.0)
    board.drive(Y, 1.0)
    board.advance(100 * MS)
    board.cut_pwm([X])
    board.advance(100 * MS)
    assert board.speed_counts_per_s(X) == 0
    assert board.speed_counts_per_s(Y) > MAXIMUM
    board.cut_pwm([])
    board.advance(100 * MS)
    assert board.speed_counts_per_s(X) > MAXIMUM


@pytest.mark.parametrize("sign", [1, -1])
def test_limit_switches_close_at_their_place_and_end_stops_hold(make, sign):
    board = make("limit_lower_mm=-0.3", "limit_upper_mm=0.2", "end_stop_mm=0.4")
    at_mm = 0.2 if sign > 0 else 0.3
    board.drive(X, sign * 0.5)
    closed = None
    for _ in range(200_000):
        board.advance(5 * US)
        pins = board.pins
        near, far = (pins.limit_upper, pins.limit_lower) if sign > 0 else (pins.limit_lower, pins.limit_upper)
        assert far == 0
        if closed is None and near:
            closed = board.position_counts(X)
            assert near == 1 << X
            break
        assert not near
    # A switch follows at the end of the plant step: within 5 us of travel.
    assert 0 <= sign * closed - at_mm * COUNTS_PER_MM <= 5e-6 * MAXIMUM
    board.advance(S)
    assert board.position_counts(X) == sign * 0.4 * COUNTS_PER_MM
    assert board.speed_counts_per_s(X) == 0
    board.drive(X, -sign * 0.5)
    board.advance(100 * MS)
    assert not board.pins.limit_lower & 1 and not board.pins.limit_upper & 1
