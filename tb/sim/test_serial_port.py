# SPDX-License-Identifier: BSD-2-Clause
"""The simulated serial line as programs for a real one use it."""

import random

from tb.sim.serial_port import SerialPort
from tb.sim.simulator import S
from tb.transcripts.runner import Host

CLOCK_PS = 20_000       # a simulation stops at ends of these


class Silence:
    """A simulation in which nothing is ever said; refuses to be run for no time."""

    def __init__(self, time_ps):
        self.time_ps = time_ps

    def run(self, duration_ps):
        assert duration_ps > 0
        self.time_ps += -(-duration_ps // CLOCK_PS) * CLOCK_PS

    def serial_read(self):
        return b""

    def serial_write(self, data):
        pass


class Watched(SerialPort):
    """Counts reads, and fails when there are too many of them for any wait of a test."""

    reads = 0

    def read(self, size=1):
        self.reads += 1
        assert self.reads < 100, "reads, and no time passes"
        return super().read(size)


def test_waiting_by_the_clock_ends_wherever_it_begins():
    """Times in seconds are rounded: what is left of a wait may be less than a picosecond, and more than nothing."""
    rng = random.Random(1)
    for _ in range(2000):
        sim = Silence(rng.randrange(10**6, 5 * 10**8) * CLOCK_PS)
        port = Watched(sim)
        began_ps = sim.time_ps
        Host(port, clock=port.clock).listen(0.02)
        assert 0 <= sim.time_ps - began_ps - S // 50 <= 2 * CLOCK_PS
        assert Host(port, patience=0.1, clock=port.clock).ask(b"W X\r") == b""
