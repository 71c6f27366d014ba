# SPDX-License-Identifier: BSD-2-Clause
"""From the hand to what moves and what is said, on the real firmware in the real gateware.

Buttons bounce, the joystick is read by the converter over SPI, knobs turn their contacts, and DIP switches are looked
at as the controller starts.
"""

import pytest

from tb.sim.simulator import MS, US

COUNTS_PER_MM = 45396
PRESS_MS = 30                           # of a short press, bounces of up to 4 ms included


def press(sim, button, milliseconds=PRESS_MS):
    sim.set_button(button, 1)
    sim.run(milliseconds * MS)
    sim.set_button(button, 0)
    sim.run(30 * MS)


def said(sim):
    return sim.serial_read().decode()


def speed_mm_per_s(sim, axis, milliseconds=20):
    before = sim.count(axis)
    sim.run(milliseconds * MS)
    return (sim.count(axis) - before) / COUNTS_PER_MM / milliseconds * 1e3


def test_a_bouncing_button_is_one_p(powered):
    assert powered.command("VB X=2") == ":A \r\n"
    for button in "joystick", "joystick_wire":
        powered.set_button(button, 1)
        powered.run(PRESS_MS * MS)
        assert said(powered) == "", "decided before it is released"
        powered.set_button(button, 0)
        powered.run(30 * MS)
        assert said(powered) == "p\r\n"


def test_zero_names_the_place(powered):
    assert powered.command("H X=100 Y=200") == ":A \r\n"
    press(powered, "zero")
    assert powered.command("W X Y") == ":A 0.0 0.0 \r\n"


def test_edges_of_in1_are_said_however_short(powered):
    assert powered.command("VB X=4") == ":A \r\n"
    at = powered.time_ps + 10 * MS
    powered.schedule_input(at, "in1", 1)
    powered.schedule_input(at + 1 * US, "in1", 0)
    powered.run(30 * MS)
    assert said(powered) == "H\r\nL\r\n"


def test_a_deflected_joystick_drives_its_axis_until_it_is_let_go(powered):
    sim = powered
    assert sim.command("RA X Y") == ":A 128 128\r\n"
    sim.set_analog(0, 0.8)
    sim.run(100 * MS)
    # Half the range, a deadband of 6 %, a square law, JSSPD X 100 % of 6.8 mm/s.
    expected = ((0.6 - 0.06) / 0.94) ** 2 * 6.8
    assert speed_mm_per_s(sim, 0) == pytest.approx(expected, rel=0.05)
    assert sim.command("/") == "N\r\n"
    assert sim.command("RA X") == ":A 204\r\n"
    sim.set_analog(0, 0.5)
    sim.run(60 * MS)
    assert speed_mm_per_s(sim, 0) == pytest.approx(0, abs=0.001)
    assert sim.count(0) > 0.1 * COUNTS_PER_MM and abs(sim.count(1) - 1) <= 1
    press(sim, "joystick")                                  # slow
    sim.set_analog(0, 0.2)
    sim.run(100 * MS)
    assert speed_mm_per_s(sim, 0) == pytest.approx(-expected / 20, rel=0.05)


def test_a_knob_moves_its_axis_by_distances(powered):
    before = powered.count(2)
    powered.turn_knob(0, 80, interval_ps=200 * US)          # 80 edges of 5 % of 10 um
    powered.run(150 * MS)
    assert powered.count(2) - before == pytest.approx(0.04 * COUNTS_PER_MM, abs=3)
    powered.turn_knob(0, -160, interval_ps=200 * US)
    powered.run(150 * MS)
    assert powered.count(2) - before == pytest.approx(-0.04 * COUNTS_PER_MM, abs=3)


@pytest.mark.parametrize("dip, baud", [(1, 28800), (2, 19200), (3, 9600)])
def test_switches_4_and_5_set_the_rate(built, dip, baud):
    with built.power_up(baud=baud) as sim:
        sim.set_dip(dip)
        sim.run(10 * MS)
        assert sim.command("/") == "N\r\n"
        assert sim.command("DIP X?") == f":A X={dip}\r\n"


def test_switch_8_reverses_x(built):
    with built.power_up() as sim:
        sim.set_dip(8)
        sim.run(20 * MS)
        before = sim.count(0)
        assert sim.command("M X=1000") == ":A \r\n"
        sim.run(200 * MS)
        assert sim.command("/") == "N\r\n"
        assert sim.count(0) - before == pytest.approx(-0.1 * COUNTS_PER_MM, abs=3)
        assert sim.command("W X") in (":A 999.9 \r\n", ":A 1000.0 \r\n", ":A 1000.1 \r\n")
