# SPDX-License-Identifier: BSD-2-Clause
"""From the serial command to the light: every period at the OUT0 pin, to the clock, while the host goes on talking."""

import re

import pytest

from tb import toolchain
from tb.sim.simulator import MS, US

FAST_PS = 5000
DEFAULT_CLOCKS = 153_846                # 1.3 kHz


def periods(changes):
    """``[(begin in ps, length, high)]`` in ``fast`` clocks, of the periods that are over."""
    rises = [int(c["time_ps"]) for c in changes if c["level"]]
    falls = [int(c["time_ps"]) for c in changes if not c["level"]]
    falls = [fall for fall in falls if fall > rises[0]]
    return [(rise, (following - rise) / FAST_PS, (fall - rise) / FAST_PS)
            for rise, fall, following in zip(rises, falls, rises[1:])]


def exposed(seen, begin_ps, length_ps):
    """Light between two times, ``fast`` clocks."""
    lit = ((max(rise, begin_ps), min(rise + int(high) * FAST_PS, begin_ps + length_ps)) for rise, _, high in seen)
    return sum(max(fall - rise, 0) for rise, fall in lit) // FAST_PS


def tell(sim, line):
    assert sim.command(line) == ":A \r\n", line


def test_the_worked_example_of_the_manual(powered):
    """TTL Y=9, LED X=25: 192 us of every 769 us, and 13 periods in an exposure of 10 ms."""
    page = (toolchain.ROOT / "docs" / "modules" / "led_dimmer.md").read_text()
    lines = re.findall(r"^    (\S.*)$", page.split("## Worked example")[1].split("##")[0], re.MULTILINE)
    assert len(lines) == 2
    tell(powered, "TTL Y=0")
    powered.record("out0")
    for line in lines:
        tell(powered, line)
    powered.run(25 * MS)
    seen = periods(powered.changes())
    assert len(seen) > 30
    assert {(length, high) for _, length, high in seen} == {(DEFAULT_CLOCKS, 38462)}       # 769.23 and 192.31 us
    # Whenever it begins, an exposure has the light of 13 periods, which are 2 clocks shorter.
    light = {exposed(seen, begin_ps, 10 * MS) for begin_ps in range(seen[2][0], seen[2][0] + 769 * US, 7 * US)}
    assert light <= {13 * 38462 + extra for extra in range(3)}
    print(f"period {seen[0][1] * FAST_PS / 1e6:.3f} us, light {seen[0][2] * FAST_PS / 1e6:.3f} us; light of an exposure of 10 ms: "
          f"{min(light) * FAST_PS / 1e9:.6f} to {max(light) * FAST_PS / 1e9:.6f} ms")


def test_brightness_and_rate_change_between_whole_periods(powered):
    """Commands as fast as the line takes them; nothing but what was asked for is ever at the pin."""
    tell(powered, "TTL Y=9 50")
    powered.run(20 * MS)
    powered.record("out0")
    asked = {(DEFAULT_CLOCKS, DEFAULT_CLOCKS // 2)}
    for rate, percent in (200000, 0.5), (20000, 30), (5000, 99.9), (100000, 12.5), (2000, 60):
        tell(powered, f"LED R={rate} X={percent}")
        clocks = round(200e6 / rate)
        asked.add((clocks, round(percent / 100 * clocks)))
        powered.command("W X Y Z F")
    powered.run(3 * MS)
    seen = {(length, high) for _, length, high in periods(powered.changes())}
    assert seen == asked


@pytest.mark.parametrize("line, level", [("TTL Y=9 0", 0), ("TTL Y=9 100", 1)])
def test_both_ends_have_no_edge(powered, line, level):
    tell(powered, "TTL Y=9 50")
    powered.run(20 * MS)
    tell(powered, line)
    powered.run(2 * MS)
    powered.record("out0")
    powered.run(20 * MS)
    assert len(powered.changes()) == 0 and powered.levels()["out0"] == level


def test_a_closed_shutter_is_dark_before_the_answer_and_opens_with_a_whole_period(powered):
    for percent in 10, 90, 40:
        tell(powered, f"TTL Y=9 {percent}")
        powered.run(20 * MS)
        powered.record("out0")
        tell(powered, "TTL Y=0")
        dark = powered.changes()
        answered = powered.time_ps
        assert powered.levels()["out0"] == 0 and all(int(c["time_ps"]) < answered - 200 * US for c in dark)
    powered.run(20 * MS)
    powered.record("out0")
    tell(powered, "TTL Y=9 40")
    powered.run(20 * MS)
    high = {high for _, _, high in periods(powered.changes())}
    assert high == {round(0.4 * DEFAULT_CLOCKS)}
