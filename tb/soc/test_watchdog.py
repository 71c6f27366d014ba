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
MARK = 0x123                    # written to a register of the PWM


@pytest.fixture(scope="module")
def awake():
    return bench.run(CLOCKS, program="watchdog")


@pytest.fixture(scope="module")
def starts(awake):
    """``[[starts before, status, register of the PWM, time-out]]`` of each start; nothing else may have been said."""
    lines = bench.serial_text(awake[0], DIVISOR).splitlines()
    assert all(re.fullmatch("start( [0-9a-f]{8}){4}", line) for line in lines), lines
    return [[int(word, 16) for word in line.split()[1:]] for line in lines]


def test_at_power_up_nothing_is_kept(starts):
    assert starts[0] == [0, Cause.POWER_UP.value | COLD, 0, TIMEOUT_CLOCKS]


def test_every_way_to_hang_ends_in_a_start_that_knows_why(starts):
    causes = [Cause.WATCHDOG] * 3 + [Cause.COMMAND] + [Cause.WATCHDOG] * 100
    assert len(starts) > 20                             # many of them out of traffic on both buses
    for n, (count, status, mark, timeout) in enumerate(starts[1:], 1):
        assert (count, mark, timeout) == (n, MARK, 3000 + 37 * (n - 1))     # registers are as they were
        assert status == causes[n - 1].value            # stopped, and no longer cold


def test_it_is_not_reset_while_it_kicks(starts, awake):
    """20 kicks 1000 clocks apart, then the time-out and the start's line of 43 characters, 10 bits each."""
    edges = [clock for clock, pin, level in awake[0] if pin == "serial_tx" and level == 0]
    begins = [edges[0]] + [b for a, b in zip(edges, edges[1:]) if b - a > 2000]
    assert len(begins) == len(starts)
    for n, (a, b) in enumerate(zip(begins, begins[1:])):
        spoken, kicks = 42 * 10 * DIVISOR, 20 * 1000
        reset = 0 if n == 3 else 3000 + 37 * n          # the fourth time the processor asks for it
        assert spoken + kicks + reset < b - a < spoken + kicks + reset + 2500, n


def test_a_sleeping_processor_whose_clock_is_left_out_is_reset_all_the_same(awake):
    events, left_out = bench.run(CLOCKS, "--stop", program="watchdog")
    assert left_out > 1500                              # from falling asleep to the reset
    assert events == awake[0]
