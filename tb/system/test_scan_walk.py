# SPDX-License-Identifier: BSD-2-Clause
"""The third walk: from a scan command to the pixel-clock pin, on the real firmware in the real gateware.

Each case sends what a host sends, records nothing but the pins, and is judged by the analyser of ``host/jitter``
and by pixel counts from the definition floor(K * L / N): pulses exact in number and place, one constant latency of
10 clocks, jitter of no more than the sampling clock.

Half of the cases and short lines in the ordinary suite; ``make test-slow`` runs them all at 1 mm (``FULL_LINES=1``).
"""

import os

import pytest

from tb.demo.__main__ import run
from tb.demo.scenario import Scenario

FULL = "FULL_LINES" in os.environ
LENGTH = "1.0" if FULL else "0.15"

CASES = {
    "forward": Scenario(stop=LENGTH),
    "slow as in the worked example": Scenario(stop="1.0" if FULL else "0.06", speed="0.528"),
    "host floods W X Y": Scenario(stop=LENGTH, flood=True),
    "plant at half speed": Scenario(stop=LENGTH, speed="1.32", plant=("speed_scale=0.5",)),
    "coordinates mirrored": Scenario(stop=LENGTH, mirrored=True),
    "negative direction": Scenario(start=LENGTH, stop="0.0"),
    "negative and mirrored": Scenario(start="0.1", stop="-0.9" if FULL else "-0.05", mirrored=True),
    "Y fast": Scenario(stop=LENGTH, axis="y"),
    "N = 38": Scenario(stop=LENGTH, n="38"),
    "N = 454": Scenario(stop="1.0" if FULL else "0.3", n="454"),
    "N = 24.4": Scenario(stop=LENGTH, n="24.4"),
    "N = 1": Scenario(stop=LENGTH if FULL else "0.05", n="1", speed="1.0"),
}
SLOW = {"forward", "plant at half speed", "coordinates mirrored", "negative direction", "N = 38", "N = 454"}


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in CASES])
def test_every_pixel_of_a_line_is_exact(built, tmp_path, name):
    report = run(CASES[name], tmp_path)
    assert report["failures"] == []
    assert report["pixels"] == CASES[name].pixels()


def test_cutting_the_motor_wire_stops_the_stage(built, tmp_path):
    report = run(Scenario(stop=LENGTH, cut_pwm=True), tmp_path)
    assert report["failures"] == []
    assert report["stop"]["standing"]
