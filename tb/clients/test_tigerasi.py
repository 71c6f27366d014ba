# SPDX-License-Identifier: BSD-2-Clause
"""tigerasi 0.0.27, with its reading of a Tiger's cards replaced by what a controller without cards has."""

import time

import pytest
from tigerasi.tiger_controller import TigerController

COUNT = 0.35


class WithoutCards(TigerController):
    """Where a Tiger lists its cards, an MS-2000 has nothing to say."""

    def get_build_config(self):
        return {"Motor Axes": ["X", "Y", "Z"], "Hex Addr": [""] * 3, "Axis Types": ["x", "x", "z"]}


@pytest.fixture
def box(twin):
    controller = WithoutCards(twin.port)
    yield controller
    controller.ser.close()


def settle(box, *axes):
    """Its own ``wait()`` never returns in this release."""
    began = time.monotonic()
    while any(box.are_axes_moving(*axes).values()):
        assert time.monotonic() - began < 20


def test_it_moves_and_says_which_axis_does(box):
    box.move_absolute(x=20000, y=-300)
    assert box.are_axes_moving("x", "z") == {"X": True, "Z": False}
    settle(box)
    box.move_relative(x=-100, z=50)
    settle(box, "x", "z")
    assert box.get_position() == {"X": pytest.approx(19900, abs=2 * COUNT), "Y": pytest.approx(-300, abs=COUNT),
                                  "Z": pytest.approx(50, abs=COUNT)}


def test_the_second_axis_is_seen_to_move(box):
    """Letters of RS are not separated, or it would not be."""
    box.move_absolute(y=20000)
    assert box.are_axes_moving("x", "y", "z") == {"X": False, "Y": True, "Z": False}


def test_positions_are_set(box):
    box.set_position(x=10, y=50)
    assert box.get_position("x", "y") == {"X": pytest.approx(10, abs=COUNT), "Y": pytest.approx(50, abs=COUNT)}
    box.zero_in_place()
    assert list(box.get_position().values()) == pytest.approx([0, 0, 0], abs=COUNT)


def test_limits_hold_a_move_and_go_back_to_their_default(box):
    default = box.get_upper_travel_limit("x")["X"]
    box.set_upper_travel_limit(x=0.5)
    assert box.get_upper_travel_limit("x") == {"X": pytest.approx(0.5, abs=1e-3)}
    box.move_absolute(x=20000)
    settle(box)
    assert box.get_position("x")["X"] == pytest.approx(5000, abs=1)
    box.reset_upper_travel_limits("x")
    assert box.get_upper_travel_limit("x")["X"] == default


def test_the_lower_limit_as_well(box):
    default = box.get_lower_travel_limit("y")["Y"]
    box.set_lower_travel_limit(y=-0.25)
    box.move_absolute(y=-20000)
    settle(box)
    assert box.get_position("y")["Y"] == pytest.approx(-2500, abs=1)
    box.reset_lower_travel_limits("y")
    assert box.get_lower_travel_limit("y")["Y"] == default


def test_settings_are_read_back(box):
    box.set_speed(x=2.5, y=1.25)
    assert box.get_speed("x", "y") == {"X": 2.5, "Y": 1.25}
    box.set_acceleration(x=80)
    assert box.get_acceleration("x") == {"X": 80}
    assert box.get_encoder_ticks_per_mm("x") == pytest.approx(45396)
    assert box.get_info("x")["Axis Name ChX"] == "X"


def test_halt_raises_and_stops(box):
    box.set_speed(x=1)
    box.move_absolute(x=20000)
    time.sleep(0.3)
    with pytest.raises(SyntaxError):
        box.halt()
    settle(box)
    assert 500 < box.get_position("x")["X"] < 10000


def test_the_joystick_is_let_go_and_taken_back(box):
    before = box.get_joystick_axis_mapping("x", "y")
    box.disable_joystick_inputs("x")
    box.enable_joystick_inputs("x")
    assert box.get_joystick_axis_mapping("x", "y") == before


def test_home_is_set_and_reached(box):
    box.set_home(x=1.0)
    assert box.get_home("x") == {"X": pytest.approx(1.0, abs=1e-3)}
    box.home("x")
    settle(box)
    assert box.get_position("x")["X"] == pytest.approx(10000, abs=COUNT)


def test_backlash_is_read_back(box):
    box.set_axis_backlash(x=0.02)
    assert box.get_axis_backlash("x") == {"X": pytest.approx(0.02)}
