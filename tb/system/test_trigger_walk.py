# SPDX-License-Identifier: BSD-2-Clause
"""From an edge at IN0 to the motor: how long after it the first duty changes, at the pins.

The edge comes at any phase of the servo tick; the axis rests, so its PWM pin is low until it is driven. Two servo periods
are the bound: up to one until a tick sees the edge, and one from a tick to its duties. What the host says meanwhile must
not matter. Ten edges a mode in ``make test-slow`` (``FULL_LINES=1``), three in the ordinary suite.
"""

import os
import random

import pytest

from tb.sim.simulator import MS, SIGNALS, US

TICK_US = 100
BOUND_US = 2 * TICK_US
EDGES = 10 if "FULL_LINES" in os.environ else 3

# The original begins within its servo loop of 0.25 ms an axis, and its trigger waits for the loop in progress.
ORIGINAL_US = 500, 1000

MODES = {
    "TTL X=2": (["R X=0 Z=20"], "z"),
    "TTL X=4": (["ZS X=20 Y=100 F=0"], "z"),
    "TTL X=1": (["RM Y=15"] + [f"LD X={100 + 40 * n} Y={50 * n}" for n in range(12)], "x"),
    "TTL X=12": (["RM Y=15", "LD X=30 Y=10 Z=20 F=-40"], "x"),
}


def first_drive_us(sim, axis, at_ps):
    """From an edge of IN0 at a time to the first rise of the axis' PWM pin."""
    pwm, in0 = SIGNALS.index(f"{axis}_pwm"), SIGNALS.index("in0")
    sim.record(f"{axis}_pwm", "in0")
    assert not sim.levels()[f"{axis}_pwm"]
    sim.schedule_input(at_ps, "in0", 1)
    sim.schedule_input(at_ps + 5 * US, "in0", 0)
    sim.run(at_ps + 3 * MS - sim.time_ps)
    changes = sim.changes()
    sim.record()
    rises = changes[changes["level"] == 1]
    edge = rises[rises["signal"] == in0]["time_ps"]
    driven = rises[rises["signal"] == pwm]["time_ps"]
    assert len(edge) == 1 and len(driven), "no drive within 3 ms"
    assert driven[0] > edge[0], "driven before the edge"
    return (int(driven[0]) - int(edge[0])) / US


def settle(sim):
    for _ in range(60):
        sim.run(10 * MS)
        if sim.command("/") == "N\r\n":
            break
    else:
        raise AssertionError("still busy after 600 ms")
    sim.run(15 * MS)                # of the loop's settling, and of planning


@pytest.mark.parametrize("mode", MODES)
def test_an_edge_drives_within_two_servo_periods(powered, mode):
    phase = random.Random(mode)
    set_up, axis = MODES[mode]
    for line in ("S X=1 Y=1 Z=1 F=1", "AC X=20 Y=20 Z=20 F=20", *set_up, mode):
        assert powered.command(line) == ":A \r\n"
    took_us = []
    for _ in range(EDGES):
        settle(powered)
        took_us.append(first_drive_us(powered, axis, powered.time_ps + phase.randrange(50 * US, 150 * US)))
    print(f"{mode}: edge to first duty {min(took_us):.1f} to {max(took_us):.1f} us, "
          f"{max(took_us) / ORIGINAL_US[0]:.2f} of the original's shortest loop")
    assert 0 < min(took_us) and max(took_us) <= BOUND_US
    assert "48" not in powered.command("DU Y").split(), "a servo tick was missed"


def test_so_it_does_while_a_host_asks(powered):
    phase = random.Random(5)
    for line in ("S Z=1", "AC Z=20", "R Z=20", "TTL X=2"):
        assert powered.command(line) == ":A \r\n"
    took_us = []
    for _ in range(EDGES):
        settle(powered)
        powered.serial_read()
        powered.serial_write(b"W X Y Z F\r" * 10)               # 8.7 ms of lines without a gap
        took_us.append(first_drive_us(powered, "z", powered.time_ps + phase.randrange(1 * MS, 8 * MS)))
        powered.run(40 * MS)
        assert powered.serial_read().count(b"\r\n") == 10
    print(f"TTL X=2 under W X Y Z F without a gap: edge to first duty {min(took_us):.1f} to {max(took_us):.1f} us")
    assert 0 < min(took_us) and max(took_us) <= BOUND_US
