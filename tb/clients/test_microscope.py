# SPDX-License-Identifier: BSD-2-Clause
"""python-microscope 0.7.0: its controller class for the MS-2000, as it is."""

from contextlib import contextmanager

import pytest
from microscope.controllers.asi import ASIMS2000

from tb.clients.conftest import LIMIT_MM, short_stage

COUNT = 0.35


@contextmanager
def connected():
    """Its time-out is how long a busy machine may keep it waiting, and how it finds the end of a page."""
    with short_stage() as twin:
        controller = ASIMS2000(twin.port, baudrate=115200, timeout=2, lights=[])
        yield controller.devices["stage"]
        controller._conn._serial.close()


@pytest.fixture(scope="module")
def stage():
    with connected() as connected_stage:
        yield connected_stage


@pytest.fixture
def fresh_stage():
    with connected() as connected_stage:
        yield connected_stage


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


def test_a_setting_reads_back_as_written(stage):
    """Its ``set_setting`` waits for ever, for an answer no MS-2000 gives; speeds it sets another way."""
    stage.axes["X"].set_speed(1.234567)
    assert stage.get_setting("Run Speed X") == 1.234567
    assert stage.get_setting("Run Speed Y") == pytest.approx(0.67 * 6.8)


def test_the_origin_is_where_it_is_put(stage):
    y = stage.axes["Y"]
    y.move_to(2000)
    stage._dev_conn.reset_position("Y")
    assert y.position == pytest.approx(0, abs=COUNT)
    y.move_to(-2000)
    stage._dev_conn.reset_position("Y")
    assert y.position == pytest.approx(0, abs=COUNT)


def test_enabling_homes_it_by_spinning_to_the_switches(fresh_stage):
    fresh_stage.enable()
    for axis in fresh_stage.axes.values():
        assert axis.limits.lower == pytest.approx(0, abs=1)
        assert axis.limits.upper == pytest.approx(2 * LIMIT_MM * 1e4, rel=0.1)
        assert axis.position == pytest.approx(axis.limits.upper / 2, abs=1 + COUNT)
