# SPDX-License-Identifier: BSD-2-Clause
"""The third walk: from a scan command to the pixel-clock pin, on the real firmware in the real gateware.

Each case sends what a host sends, records nothing but the pins, and is judged by the analyser of ``host/jitter``
and by pixel counts from the definition floor(K * L / N): pulses exact in number and place, one constant latency,
jitter of no more than the sampling clock.
"""

import pytest

from tb.demo.__main__ import run
from tb.demo.scenario import Scenario

CASES = {
    "forward": Scenario(stop="0.15"),
    "slow as in the worked example": Scenario(stop="0.06", speed="0.528"),
    "host floods W X Y": Scenario(stop="0.15", flood=True),
    "plant at half speed": Scenario(stop="0.15", speed="1.32", plant=("speed_scale=0.5",)),
    "coordinates mirrored": Scenario(stop="0.15", mirrored=True),
    "negative direction": Scenario(start="0.15", stop="0.0"),
    "negative and mirrored": Scenario(start="0.1", stop="-0.1", mirrored=True),
    "Y fast": Scenario(stop="0.15", axis="y"),
    "N = 38": Scenario(stop="0.15", n="38"),
    "N = 454": Scenario(stop="0.3", n="454"),
    "N = 24.4": Scenario(stop="0.15", n="24.4"),
    "N = 1": Scenario(stop="0.05", n="1", speed="1.0"),
}


@pytest.mark.parametrize("name", CASES)
def test_every_pixel_of_a_line_is_exact(built, tmp_path, name):
    report = run(CASES[name], tmp_path)
    assert report["failures"] == []
    assert report["pixels"] == CASES[name].pixels()


def test_cutting_the_motor_wire_stops_the_stage(built, tmp_path):
    report = run(Scenario(stop="0.15", cut_pwm=True), tmp_path)
    assert report["failures"] == []
    assert report["stop"]["standing"]
