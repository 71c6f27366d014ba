# SPDX-License-Identifier: BSD-2-Clause
"""The controller under test: today's gateware and firmware, built once, and powered up for each test."""

import pytest

from tb.sim import controller
from tb.sim.simulator import MS


@pytest.fixture(scope="session")
def built():
    return controller.build()


@pytest.fixture
def powered(built):
    """A controller that has just answered its first command, on the default board; ``make(...)`` for another."""
    with built.power_up() as sim:
        sim.run(20 * MS)
        assert sim.command("/") == "N\r\n"
        yield sim
