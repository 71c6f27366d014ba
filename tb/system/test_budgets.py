# SPDX-License-Identifier: BSD-2-Clause
"""The firmware's share of docs/timing.md: prints each figure (``pytest -s``) and bounds it."""

import pytest

from tb.sim.simulator import MS, US

PERIOD_CLOCKS = 5_000               # of the servo tick: 2 PWM periods of 2500
BIT_US = 434 * 0.02


def tick_clocks(sim):
    """(last, longest) of the servo interrupt, in processor clocks."""
    return tuple(map(int, sim.command("TICK").split()[1:]))


def test_the_servo_tick_takes_three_fifths_of_the_processor_at_most(powered):
    early, _ = tick_clocks(powered)
    powered.command("M X=3000 Y=3000 Z=300 F=300")
    moving = []
    for _ in range(8):
        powered.run(5 * MS)
        moving.append(tick_clocks(powered)[0])
        powered.command("W X Y Z F")
    assert powered.command("/") == "B\r\n"
    longest = tick_clocks(powered)[1]
    powered.run(120 * MS)
    assert powered.command("/") == "N\r\n"
    rest, _ = tick_clocks(powered)
    print(f"servo interrupt, 4 axes: {early} clocks after power-up, {min(moving)} to {max(moving)} while all move, "
          f"longest {longest}, {rest} at rest, of {PERIOD_CLOCKS}")
    assert 0 < rest < min(moving) and max(moving) <= longest <= PERIOD_CLOCKS * 6 // 10


@pytest.mark.parametrize("command", ["/", "W X", "W X Y Z F", "V", "S X?", "FOO", "M X=100"])
def test_a_reply_begins_within_its_budget(powered, command):
    """From the end of the stop bit of CR to the start bit of the reply."""
    powered.serial_read()
    powered.serial_write(command.encode() + b"\r")
    powered.run_until(lambda: not powered.serial_unsent, timeout_ps=50 * MS, every_ps=US)
    sent_ps = powered.time_ps
    powered.run_until_lines(1, timeout_ps=100 * MS)
    data, times = powered.serial_read_timed()
    took_us = (int(times[0]) - sent_ps) / US
    print(f"{command}: {took_us:.0f} us to the first byte of the reply")
    assert 0 < took_us < 5000
    # Once begun it goes out without a gap.
    assert (times[-1] - times[0]) / US <= (len(data) - 1) * 10 * BIT_US + 1 * len(data)
