# SPDX-License-Identifier: BSD-2-Clause
"""A processor that hangs, however it does, is reset alone and starts again at the boot vector; registers stay.

``program/watchdog.c`` hangs in another way at each start and says what it finds.
"""

import re

import pytest

from rtl.watchdog import TIMEOUT_CLOCKS, Cause
from tb.soc import bench

CLOCKS = 900_000
DIVISOR = 8                     # set by the program
RUNNING, COLD = 4, 8
MARK = 0x123                    # written to a register of the PWM: the drive of X
WATCHDOG, ESTOP = 1 << 16, 1 << 17      # faults of the interlock


@pytest.fixture(scope="module")
def awake():
    return bench.run(CLOCKS, program="watchdog")


@pytest.fixture(scope="module")
def starts(awake):
    """``[[starts before, status, register of the PWM, time-out, faults]]`` of each start; nothing else was said."""
    lines = bench.serial_text(awake[0], DIVISOR).splitlines()
    assert all(re.fullmatch("start( [0-9a-f]{8}){5}", line) for line in lines), lines
    return [[int(word, 16) for word in line.split()[1:]] for line in lines]


def test_at_power_up_nothing_is_kept(starts):
    assert starts[0] == [0, Cause.POWER_UP.value | COLD, 0, TIMEOUT_CLOCKS, ESTOP]


def test_every_way_to_hang_ends_in_a_start_that_knows_why(starts):
    causes = [Cause.WATCHDOG] * 3 + [Cause.COMMAND] + [Cause.WATCHDOG] * 100
    assert len(starts) > 20                             # many of them out of traffic on both buses
    for n, (count, status, mark, timeout, faults) in enumerate(starts[1:], 1):
        assert (count, mark, timeout) == (n, MARK, 3000 + 37 * (n - 1))     # registers are as they were
        assert status == causes[n - 1].value            # stopped, and no longer cold
        assert faults == WATCHDOG


def test_it_is_not_reset_while_it_kicks(starts, awake):
    """20 kicks 1000 clocks apart, then the time-out and the start's line of 52 characters, 10 bits each."""
    edges = [clock for clock, pin, level in awake[0] if pin == "serial_tx" and level == 0]
    begins = [edges[0]] + [b for a, b in zip(edges, edges[1:]) if b - a > 2000]
    assert len(begins) == len(starts)
    for n, (a, b) in enumerate(zip(begins, begins[1:])):
        spoken, kicks = 51 * 10 * DIVISOR, 20 * 1000
        reset = 0 if n == 3 else 3000 + 37 * n          # the fourth time the processor asks for it
        assert spoken + kicks + reset < b - a < spoken + kicks + reset + 2500, n


def test_a_hung_processor_starts_again_with_its_drives_off(awake, starts):
    """From its end to the clear by the program that starts, behind its line, nothing is driven."""
    events = [(clock, level) for clock, pin, level in awake[0] if pin == "motor_enable"]
    rises, falls = ([clock for clock, level in events if level == wanted] for wanted in (1, 0))
    falls = [clock for clock in falls if clock > rises[0]]
    lines = [clock for clock, pin, level in awake[0] if pin == "serial_tx" and level == 0]
    pwm = [clock for clock, pin, level in awake[0] if pin == "pwm" and level]
    assert len(rises) >= len(starts) - 1 and len(falls) >= len(starts) - 1
    for off, on in zip(falls, rises[1:]):
        assert sum(off < clock < on for clock in lines) > 100
        assert not any(off < clock < on for clock in pwm)
    assert pwm


@pytest.mark.parametrize("option", [(), ("--hold", "30000")])
def test_a_fault_acts_while_the_processor_floods_its_bus_and_while_it_is_held_in_reset(option):
    """X is driven at four fifths and its encoder stands; Y is driven less than would move it."""
    events, _ = bench.run(140_000, *option, program="drive")
    levels = [(clock, level) for clock, pin, level in events if pin == "pwm"]
    first = min(clock for clock, level in levels if level & 1)
    last = max(clock for clock, level in levels if level & 1)
    print(f"off after {(last - first) / 50} us")
    assert 46_000 < last - first < 48_200               # 0.96 ms
    assert max(clock for clock, level in levels if level & 2) > 135_000


def test_the_stop_acts_while_the_processor_floods_its_bus():
    events, _ = bench.run(60_000, "--estop", "40000", program="drive")
    levels = [(clock, level) for clock, pin, level in events if pin == "pwm"]
    assert any(30_000 < clock for clock, level in levels if level)
    assert not any(clock > 40_000 + 3 for clock, level in levels if level)


def test_a_sleeping_processor_whose_clock_is_left_out_is_reset_all_the_same(awake):
    events, left_out = bench.run(CLOCKS, "--stop", program="watchdog")
    assert left_out > 1500                              # from falling asleep to the reset
    assert events == awake[0]
