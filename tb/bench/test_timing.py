# SPDX-License-Identifier: BSD-2-Clause
"""The figures of the timing modules: which there are, how they are judged, and one group of them measured."""

import json

import pytest

from tb.bench import timing


def test_every_figure_of_the_original_is_measured_once():
    named = [name for _, names in timing.MEASUREMENTS.values() for name in names]
    assert sorted(named) == sorted(timing.originals())


@pytest.mark.parametrize("better, theirs, ours, beats, ratio", [
    ("less", 10, 2, True, 5), ("less", 10, 10, False, 1), ("less", 10, 20, False, 0.5), ("less", 10, 0, True, None),
    ("less", 0, 0, True, None), ("less", 0, 1, False, None), ("more", 10, 20, True, 2), ("more", 10, 10, False, 1),
    ("more", 99, 0, False, None), ("less", None, 3, None, None)])
def test_ours_is_judged_by_the_original(better, theirs, ours, beats, ratio):
    original = {"name": "a", "unit": "us", "better": better, "source": "b"} | ({} if theirs is None else {"value": theirs})
    row = timing.judged(original, ours, "c")
    assert (row["beats"], row["ratio"], row["ours"], row["original"]) == (beats, ratio, ours, theirs)


def test_a_group_is_measured_and_written(capsys):
    assert timing.main(["light"]) == 0
    rows = json.loads((timing.DIRECTORY / "timing.json").read_text())["rows"]
    assert [set(row) >= {"name", "unit", "original", "ours", "ratio", "beats", "command"} for row in rows] == [True] * 4
    ours = {row["name"]: row["ours"] for row in rows}
    assert ours["LED: highest brightness"] == 100 and ours["LED: highest frequency"] == 200
    assert ours["LED: smallest step of brightness"] == pytest.approx(100 / 153_846, rel=1e-3)
    assert 0 < ours["LED: light of exposures of 10 ms at 25 %, most less least"] <= 0.01
    assert (timing.DIRECTORY / "timing.png").stat().st_size > 1000


def test_a_group_that_is_not_there_is_told():
    with pytest.raises(SystemExit):
        timing.main(["nothing"])
