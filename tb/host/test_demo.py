# SPDX-License-Identifier: BSD-2-Clause
"""The demonstration says exact when the line is, and fails for each thing that can be wrong with it.

The controller is a stand-in here (:mod:`tb.host.fake_controller`); the real one is tested in ``tb/system``.
"""

import json
from fractions import Fraction

import pytest

from tb.demo.__main__ import main
from tb.demo.scenario import Scenario
from tb.host.fake_controller import RIPPLE_COUNTS, FakeController
from tb.host.scope import CLOCK_PS

LINE = ("--stop", "0.2", "--speed", "5.28")
PIXELS = 378                                                 # 45396 * 0.2 / 24 = 378.3


def demo(tmp_path, *options, spoil=None, answers=None):
    """Run it; return exit status, report and what the controller received."""
    made = []

    def make(plant):
        made.append(FakeController(spoil, answers))
        return made[0]

    status = main([*LINE, *options, "--out", str(tmp_path)], make)
    return status, json.loads((tmp_path / "report.json").read_text()), made[0].received


def test_the_worked_example_has_1891_pixels_and_12_counts_left_over():
    scenario = Scenario(speed="0.528")
    assert scenario.pixels() == 1891
    assert scenario.left_over_counts() == 12
    assert scenario.commands() == [
        "SCANR X=0.0 Y=1.0 Z=24", "SCANV X=0.0 Y=1.0 Z=1", "SPEED X=0.528", "SCAN F=0", "TTL X=1", "SCAN"]


@pytest.mark.parametrize("n, pixels", [("24", 1891), ("38", 1194), ("454", 99), ("24.4", 1860)])
def test_pixels_are_computed_from_the_definition(n, pixels):
    assert Scenario(n=n).pixels() == pixels


def test_exact_line(tmp_path, capsys):
    status, report, received = demo(tmp_path)
    assert status == 0 and report["failures"] == []
    assert (report["pixels"], report["missed"], report["extra"], report["sync_edges"]) == (PIXELS, 0, 0, 1)
    assert (report["start_counts"], report["end_counts"]) == (0, PIXELS * 24)
    assert report["latency_clocks"] == 10 and report["jitter_ns"]["pp"] < 5.002
    # A sine of known height: the only thing between the stage and a perfect line.
    assert report["following_error_counts"]["rms"] == pytest.approx(RIPPLE_COUNTS / 2**0.5, rel=0.1)
    assert report["following_error_counts"]["max"] == pytest.approx(RIPPLE_COUNTS, rel=0.15)
    assert report["simulated_s"] > 0.05 and report["wall_s"] > 0
    assert [command for command in received if command != "/"] == Scenario(speed="5.28", stop="0.2").commands()
    assert {"report.json", "report.txt", "scan.png", "pins.vcd"} <= {path.name for path in tmp_path.iterdir()}
    assert "The line is exact." in capsys.readouterr().out
    text = (tmp_path / "report.txt").read_text()
    assert '"a few" counts' in text and "SCANR X=0.0 Y=0.2 Z=24" in text


def test_pins_file_has_all_its_signals_at_one_picosecond(tmp_path):
    demo(tmp_path)
    head = (tmp_path / "pins.vcd").read_text()[:2000]
    assert "$timescale 1 ps" in head
    assert [line.split()[4] for line in head.splitlines() if line.startswith("$var")] == \
        "x_a x_b y_a y_b sync encoder in0 out0".split()


@pytest.mark.parametrize("options, start, end", [
    (("--negative",), 9079, 9079 - PIXELS * 24),
    (("--mirrored",), 0, -PIXELS * 24),
    (("--axis", "y"), 0, PIXELS * 24),
    (("--n", "38"), 0, 238 * 38),
    (("--n", "24.4"), 0, 9077),                              # ceil(372 * 24.4) = 9076.8
])
def test_variants_are_exact(tmp_path, options, start, end):
    status, report, _ = demo(tmp_path, *options)
    assert report["failures"] == [] and status == 0
    assert (report["start_counts"], report["end_counts"]) == (start, end)


def test_flood_is_counted_and_answered(tmp_path):
    status, report, received = demo(tmp_path, "--flood")
    assert status == 0
    assert report["flood_replies"] == received.count("W X Y") > 10


def drop(scope):
    del scope.pulses[100]


def add(scope):
    scope.pulses.append([scope.pulses[50][0] + 30_000_000, scope.pulses[50][0] + 31_000_000])


def move(scope):
    scope.pulses[200] = [time_ps + CLOCK_PS for time_ps in scope.pulses[200]]


def one_too_few(scope):
    del scope.pulses[-1]


def slow(scope, clocks=1):
    for pair in scope.pulses + scope.sync:
        pair[:] = [time_ps + clocks * CLOCK_PS for time_ps in pair]


def fast(scope):
    slow(scope, -1)


def second_sync(scope):
    scope.sync.append([scope.sync[0][1] + 10_000_000, scope.sync[0][1] + 11_000_000])


def late_reference(scope):
    """SYNC and pixels all one pixel on: exact among themselves, and in the wrong place."""
    scope.pulses.clear()
    scope.sync.clear()
    scope.lines = [(edge + 24, direction) for edge, direction in scope.lines]
    scope.run()


def silent(scope):
    scope.pulses.clear()


@pytest.mark.parametrize("spoil, said", [
    (drop, "missed: 1"), (add, "extra: 1"), (move, "moved: 1"), (one_too_few, "missed: 1"),
    (slow, "latency, clocks: 11, expected 10"), (fast, "latency, clocks: 9, expected 10"),
    (second_sync, "SYNC edges: 2"), (late_reference, "start, counts: 24"),
    (silent, f"missed: {PIXELS}"),
])
def test_every_defect_fails_the_demo(tmp_path, spoil, said):
    status, report, _ = demo(tmp_path, spoil=spoil)
    assert status == 1
    assert any(said in failure for failure in report["failures"]), report["failures"]


@pytest.mark.parametrize("answers, said", [
    ({"TTL X=1": ":N-4"}, "'TTL X=1' was answered ':N-4'"),
    ({"W X Y": ":A"}, "'W X Y' was answered ':A'"),
])
def test_a_wrong_reply_fails_the_demo(tmp_path, answers, said):
    status, report, _ = demo(tmp_path, "--flood", answers=answers)
    assert status == 1
    assert said in report["failures"]


def test_a_scan_that_never_starts_fails_and_still_reports(tmp_path):
    status, report, _ = demo(tmp_path, answers={"SCAN": ":A"})
    assert status == 1
    assert "SYNC did not come" in report["failures"][0]
    assert report["following_error_counts"] is None


def test_cut_pwm_must_stop_the_stage(tmp_path):
    status, report, _ = demo(tmp_path, "--cut-pwm")
    assert status == 0 and report["stop"]["standing"]
    assert PIXELS // 2 <= report["pixels"] < PIXELS


def test_a_stage_that_goes_on_after_the_cut_fails(tmp_path, monkeypatch):
    monkeypatch.setattr(FakeController, "cut_pwm", lambda self, axes: None)
    status, report, _ = demo(tmp_path, "--cut-pwm", "--speed", "0.1")
    assert status == 1 and "did not stop" in report["failures"][0]


@pytest.mark.parametrize("options", [
    ("--n", "0"), ("--n", "many"), ("--speed", "0"), ("--speed", "8"), ("--speed", "5", "--half-speed"),
    ("--start", "0.2"), ("--plant", "colour=3"), ("--plant", "x.running_friction=much"), ("--n", "1/0"),
    ("--n", "24/5"), ("--n", "9080"), ("--stop", "80"), ("--start", "-56"), ("--stop", "54.99", "--axis", "y",
                                                                            "--plant", "limit_upper_mm=50"),
])
def test_senseless_options_are_refused_in_one_sentence(options, capsys):
    with pytest.raises(SystemExit) as refused:
        main([*LINE, *options])
    assert refused.value.code == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ") and error.count("\n") == 1
    assert options[1].split("=")[0] in error or "length" in error or "limit" in options[-1]


def test_a_line_that_the_controller_refuses_is_said_and_leaves_no_report(tmp_path, capsys):
    status = main([*LINE, "--n", "1", "--out", str(tmp_path)], lambda plant: FakeController(answers={"SCAN": ":N-4"}))
    assert status == 2 and list(tmp_path.iterdir()) == []
    assert "could not run: 'SCAN' was answered ':N-4'" in capsys.readouterr().err


def test_a_controller_that_cannot_be_built_is_said(tmp_path, capsys):
    def broken(plant):
        raise RuntimeError("make failed with status 2")
    assert main([*LINE, "--out", str(tmp_path)], broken) == 2
    assert "could not run: make failed" in capsys.readouterr().err


def test_ctrl_c_is_said_in_a_sentence(tmp_path, capsys, monkeypatch):
    def interrupted(self, duration_ps):
        raise KeyboardInterrupt
    monkeypatch.setattr(FakeController, "run", interrupted)
    assert main([*LINE, "--out", str(tmp_path)], lambda plant: FakeController()) == 130
    assert capsys.readouterr().err.strip().splitlines()[-1] == "stopped: nothing was measured"
    assert list(tmp_path.iterdir()) == []


def test_two_demos_at_once_do_not_spoil_each_other(tmp_path, monkeypatch):
    """The second one runs from end to end while the first is half-way."""
    statuses, write = [], FakeController.serial_write

    def start_another(self, data):
        if data == b"SCAN\r" and not statuses:
            statuses.append(None)
            statuses[0] = main([*LINE, "--n", "38", "--out", str(tmp_path)], lambda plant: FakeController())
        write(self, data)
    monkeypatch.setattr(FakeController, "serial_write", start_another)
    status, report, _ = demo(tmp_path)
    assert (status, statuses) == (0, [0]) and report["pixels"] == PIXELS
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pins.vcd", "report.json", "report.txt", "scan.png"]


def test_pins_that_cannot_be_measured_are_said(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("tb.sim.vcd.VcdWriter.__init__.__kwdefaults__", {"signals": ("y_a", "y_b")})
    assert main([*LINE, "--out", str(tmp_path)], lambda plant: FakeController()) == 2
    assert "could not run: no channel 'x_a'" in capsys.readouterr().err


def test_the_terminal_shows_the_transcript_once(tmp_path, capsys):
    demo(tmp_path)
    shown = capsys.readouterr()
    assert (shown.out + shown.err).count("SCANR X=0.0") == 1
    assert (tmp_path / "report.txt").read_text().count("SCANR X=0.0") == 1


def test_half_speed_plant_is_asked_for(tmp_path):
    scenario = Scenario(speed="2.64", plant=("speed_scale=0.5",))
    assert scenario.maximum_speed_mm_s() < 3.4
    assert scenario.counts_per_mm() == Fraction(45396)
