# SPDX-License-Identifier: BSD-2-Clause
"""python-microscope 0.7.0: its controller class for the MS-2000, as it is."""

import pytest
from microscope.controllers.asi import ASIMS2000

from tb.clients.conftest import LIMIT_MM

COUNT = 0.35


@pytest.fixture
def stage(twin):
    controller = ASIMS2000(twin.port, baudrate=115200, timeout=0.5, lights=[])
    yield controller.devices["stage"]
    controller._conn._serial.close()


def test_it_finds_the_axes_and_two_thirds_of_their_speed(stage):
    assert list(stage.axes) == ["X", "Y", "Z"]
    for axis in stage.axes.values():
        assert axis.speed == pytest.approx(0.67 * 6.8)


def test_it_moves_and_waits(stage):
    x, y = stage.axes["X"], stage.axes["Y"]
    x.move_to(15000)
    assert x.position == pytest.approx(15000, abs=COUNT)
    x.move_by(-700)
    y.move_to(-1234)
    assert x.position == pytest.approx(14300, abs=COUNT)
    assert y.position == pytest.approx(-1234, abs=COUNT)


def test_every_setting_that_it_finds_can_be_asked_for(stage):
    names = stage.get_all_settings()
    assert len(names) > 30
    commands = {name: values["command"] for name, values in stage._dev_conn.axis_info["X"].items() if values["command"]}
    assert commands
    for name in commands:
        assert stage.get_setting(f"{name} X") is not None


def test_enabling_homes_it_by_spinning_to_the_switches(stage, needs):
    needs("SPIN X=0")
    stage.enable()
    for axis in stage.axes.values():
        assert axis.limits.lower == pytest.approx(0, abs=1)
        assert axis.limits.upper == pytest.approx(2 * LIMIT_MM * 1e4, rel=0.1)
        assert axis.position == pytest.approx(axis.limits.upper / 2, abs=1 + COUNT)
