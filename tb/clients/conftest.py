# SPDX-License-Identifier: BSD-2-Clause
"""A virtual controller for host programs that other people wrote, on a stage short enough to be homed."""

import pytest

from tb.twin.twin import Twin

LIMIT_MM = 3.0


def short_stage():
    """A twin with limit switches at 3 mm from the middle, so that a program may drive to them."""
    return Twin(plant_overrides=[f"limit_lower_mm={-LIMIT_MM}", f"limit_upper_mm={LIMIT_MM}", "end_stop_mm=4"])


@pytest.fixture
def twin():
    with short_stage() as running:
        yield running
