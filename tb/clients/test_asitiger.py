# SPDX-License-Identifier: BSD-2-Clause
"""asitiger 0.2.1: as it is, but for its listing of axes, which only a Tiger can answer."""

import time

import pytest
from asitiger.status import AxisEnabledStatus, Status
from asitiger.tigercontroller import TigerController

COUNT = 0.35            # tenths of a micron: a count of the encoder, and the rounding of WHERE


@pytest.fixture
def controller(twin):
    tiger = TigerController.from_serial_port(twin.port)
    yield tiger
    tiger.connection.disconnect()


def test_it_moves_and_waits(controller):
    assert controller.status() is Status.IDLE
    controller.move({"X": 10000, "Y": -2000.5})
    assert controller.is_busy()
    controller.wait_until_idle()
    place = controller.where(["X", "Y", "Z"])
    assert place["X"] == pytest.approx(10000, abs=COUNT) and place["Y"] == pytest.approx(-2000.5, abs=COUNT)
    assert place["Z"] == pytest.approx(0, abs=COUNT)


def test_relative_moves_add_up(controller):
    for _ in range(3):
        controller.move_relative({"X": -500})
        controller.wait_until_idle()
    assert controller.where(["X"])["X"] == pytest.approx(-1500, abs=3 * COUNT)


def test_the_origin_is_where_it_is_put(controller):
    controller.move({"X": 3000})
    controller.wait_until_idle()
    controller.here({"X": 0, "Y": 100})
    assert controller.where(["X", "Y"]) == {"X": pytest.approx(0, abs=COUNT), "Y": pytest.approx(100, abs=COUNT)}


def test_halt_stops_a_move_which_it_takes_for_an_error(controller):
    controller.speed({"X": 1})
    controller.move({"X": 20000})
    time.sleep(0.3)
    with pytest.raises(Exception, match="-21"):
        controller.halt()
    controller.wait_until_idle()
    time.sleep(0.1)                     # not busy as of the HALT, but it has to brake
    stopped = controller.where(["X"])["X"]
    assert 500 < stopped < 10000
    time.sleep(0.2)
    assert controller.where(["X"])["X"] == pytest.approx(stopped, abs=2 * COUNT)
    controller.halt()                   # nothing moves: acknowledged


def test_settings_are_read_back(controller):
    controller.speed({"X": 2.5})
    assert controller.speed({"X": "?", "Y": "?"}) == {"X": "2.500000", "Y": "4.556000"}
    controller.set_home({"X": -1.25, "Y": 3})
    assert controller.send_command("HM X? Y?") == ":A X=-1.250 Y=3.000"


def test_axes_are_disabled_and_enabled(controller):
    controller.disable_axes(["X", "Y"])
    assert [status.enabled for status in controller.rdstat(["X", "Y"])] == 2 * [AxisEnabledStatus.DISABLED]
    controller.enable_axes(["X", "Y"])
    assert [status.enabled for status in controller.rdstat(["X", "Y"])] == 2 * [AxisEnabledStatus.ENABLED]


def test_who_and_build_are_lines(controller):
    assert controller.who()[0].startswith(":A ASI-MS2000-XYZF")
    assert any(line.startswith("Motor Axes: X Y Z F") for line in controller.build())


def test_what_is_not_there_is_an_error(controller):
    with pytest.raises(Exception, match="N-1"):
        controller.secure({"X": 1})
    assert controller.status() is Status.IDLE


def test_home_is_reached(controller):
    controller.set_home({"X": 0.5})
    controller.home(["X"])
    controller.wait_until_idle()
    assert controller.where(["X"])["X"] == pytest.approx(5000, abs=COUNT)
