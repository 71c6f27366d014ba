# SPDX-License-Identifier: BSD-2-Clause
"""The bench's figures hold, with every motor and friction; its judgement can fail."""

import json

from tb.bench import __main__ as bench


def test_every_figure_is_within_its_bound():
    assert bench.main() == 0
    results = json.loads((bench.DIRECTORY / "motion.json").read_text())
    assert len(results) == len(bench.SCREWS) * len(bench.PLANTS)
    # Nothing is faster than its speed allows: 9 mm and a ramp.
    floors = {"A": 5294, "B": 1324, "C": 667, "D": 346}
    assert all(floors[r["screw"]] < r["far_ms"] and 20 < r["near_ms"] and r["fast_rms"] > 0.05 for r in results)


def test_a_sluggish_loop_is_found_out():
    screw = bench.SCREWS[1]
    assert bench.misses(screw, bench.measure(screw, bench.PLANTS["time constant +30 %"], "/KP X=80", "/KD X=70"))
