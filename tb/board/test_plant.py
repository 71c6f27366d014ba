# SPDX-License-Identifier: BSD-2-Clause
"""Parameters: the file, overrides, and what the model refuses."""

import pytest

from tb.board import plant
from tb.board.board import Board


def test_an_axis_overrides_the_default():
    parameters = plant.load()
    assert parameters["x.start_counts"] != parameters["y.start_counts"]
    assert parameters["y.pitch_mm"] == parameters["x.pitch_mm"]


def test_overrides_set_and_scale_one_axis_or_all():
    parameters = plant.load(["mechanical_time_constant_ms*=2", "y.counts_per_mm=1000", "plant_step_ns=1000"])
    assert [parameters[f"{axis}.mechanical_time_constant_ms"] for axis in plant.AXES] == [14.0] * 4
    assert [parameters[f"{axis}.counts_per_mm"] for axis in plant.AXES] == [45396, 1000, 45396, 45396]
    assert parameters["plant_step_ns"] == 1000


@pytest.mark.parametrize("override", ["speed_scale", "w.speed_scale=1", "speed=1", "speed_scale=fast", "=1", ""])
def test_a_wrong_override_is_refused(override):
    with pytest.raises(ValueError):
        plant.load([override])


@pytest.mark.parametrize("wrong", [
    "pitch_mm=0", "counts_per_mm=-1", "speed_scale=0", "free_speed_ratio=0", "electrical_time_constant_ms=0",
    "mechanical_time_constant_ms=-7", "running_friction=0.2", "breakaway_friction=nan", "limit_lower_mm=60",
    "end_stop_mm=-1", "x.start_counts=1e9", "plant_step_ns=0", "plant_step_ns=0.5e-4",
])
def test_a_plant_that_makes_no_sense_is_refused(wrong):
    with pytest.raises(ValueError, match=wrong.partition("=")[0].partition(".")[2] or wrong.partition("=")[0]):
        Board(wrong)


@pytest.mark.parametrize("change, message", [
    (lambda text: text + "z.colour=3\n", "z.colour"),
    (lambda text: text + "z.pitch_mm=3\n", "z.pitch_mm"),
    (lambda text: text.replace("f.pitch_mm=6.35\n", ""), "f.pitch_mm"),
    (lambda text: text.replace("f.pitch_mm=6.35\n", "f.pitch_mm=6,35\n"), "f.pitch_mm"),
    (lambda text: text + "pitch\n", "pitch"),
])
def test_the_text_must_name_every_parameter_once(change, message):
    with pytest.raises(ValueError, match=message):
        Board(parameters=change(plant.render(plant.load())))


def test_text_reads_back_as_the_same_numbers():
    parameters = plant.load(["x.start_counts=0.1", "y.counts_per_mm=45396.12345678901"])
    read = dict(line.split("=") for line in plant.render(parameters).splitlines())
    assert {name: float(text) for name, text in read.items()} == {n: float(v) for n, v in parameters.items()}
