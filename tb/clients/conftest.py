# SPDX-License-Identifier: BSD-2-Clause
"""A virtual controller for host programs that other people wrote, on a stage short enough to be homed."""

import pytest
import serial

from tb.twin.twin import Twin

LIMIT_MM = 3.0


@pytest.fixture
def twin():
    """Limit switches at 3 mm from the middle, so that a program may drive to them."""
    with Twin(plant_overrides=[f"limit_lower_mm={-LIMIT_MM}", f"limit_upper_mm={LIMIT_MM}", "end_stop_mm=4"]) as running:
        yield running


@pytest.fixture
def needs(twin):
    """``needs("SPIN")`` skips a test of a command that the firmware does not have."""
    def check(command):
        with serial.Serial(twin.port, timeout=2) as line:
            line.write(command.encode() + b"\r")
            if line.read_until(b"\n").strip() == b":N-1":
                pytest.skip(f"{command} is not built")
    return check
