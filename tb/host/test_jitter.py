# SPDX-License-Identifier: BSD-2-Clause
"""The analyser must find a line exact when it is, and say which pulse is wrong when one is.

Files come from :mod:`tb.host.scope`, an independent model of the pins.
"""

import json
import random
import subprocess
import sys
from fractions import Fraction
from math import ceil, floor
from pathlib import Path

import pytest

from host.jitter.cli import main
from tb.host.scope import CLOCK_PS, Scope, onward, then, travel

ROOT = Path(__file__).resolve().parents[2]
PIXELS = 300
BEFORE, AFTER = 400, 60
MEAN_PS = 400_000
LATENCY = 10
HEADER = ("$timescale 1 ps $end\n" + "".join(f"$var wire 1 {code} {name} $end\n" for code, name in
          zip("!abc", ("x_a", "x_b", "sync", "encoder"))) + "$enddefinitions $end\n")


def line(n=24, pixels=PIXELS, direction=1, seed=1, mean_ps=MEAN_PS, **more):
    """One straight line with run-up and overrun."""
    length = BEFORE + int(pixels * Fraction(n)) + AFTER
    reference = BEFORE if direction > 0 else 1 - BEFORE
    return Scope(travel(direction * length, mean_ps, seed), n, pixels, [(reference, direction)], **more).run()


def analyse(path, *options, expect=0):
    """Run the command line; return the figures."""
    out = path.with_suffix(".json")
    out.unlink(missing_ok=True)
    status = main([str(path), "--strict", "--json", str(out), *map(str, options)])
    assert status == expect
    return json.loads(out.read_text())


def test_exact_line_is_exact(tmp_path):
    figures = analyse(line().write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS)
    assert figures["findings"] == []
    assert (figures["pixels"], figures["missed"], figures["extra"], figures["moved"]) == (PIXELS, 0, 0, 0)
    assert figures["sync_edges"] == 1
    assert figures["start_counts"] == BEFORE
    assert figures["end_counts"] == BEFORE + PIXELS * 24
    assert figures["latency_clocks"] == LATENCY
    # Sampling adds 0 to 1 clock to the latency and nothing else does.
    assert LATENCY * 5 <= figures["latency_ns"]["min"] < LATENCY * 5 + 0.2
    assert (LATENCY + 1) * 5 - 0.2 < figures["latency_ns"]["max"] < (LATENCY + 1) * 5
    assert 4.8 < figures["jitter_ns"]["pp"] < 5.002
    assert figures["jitter_ns"]["rms"] == pytest.approx(5 / 12**0.5, rel=0.1)   # uniform over a clock
    assert 0.8 < figures["period_jitter_clocks"]["max"] < 1
    assert figures["phase_bins_spread"] and sum(figures["phase_bins"]) == pytest.approx(100, abs=0.1)
    assert figures["clock_phase_ns"] == pytest.approx(1.234)
    assert figures["pulse_width_ns"]["min"] == figures["pulse_width_ns"]["max"] == 50


def test_n_and_pixels_come_from_the_data_when_not_given(tmp_path):
    figures = analyse(line(n=38).write_vcd(tmp_path / "pins.vcd"))
    assert figures["counts_per_pixel"] == 38
    assert "N = 38 is taken from the data" in figures["notes"][0]
    assert figures["pixels_expected"] == PIXELS


@pytest.mark.parametrize("k", [1, 2, 150, PIXELS - 1, PIXELS])
def test_a_deleted_pulse_is_named_and_nothing_shifts(tmp_path, k):
    scope = line()
    del scope.pulses[k - 1]
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert figures["lines"][0]["missed_k"] == [k]
    assert (figures["pixels"], figures["missed"], figures["extra"], figures["moved"]) == (PIXELS - 1, 1, 0, 0)
    assert any(f"pixel {k} is missing" in finding for finding in figures["findings"])
    assert figures["jitter_ns"]["pp"] < 5.002


@pytest.mark.parametrize("k", [1, 150, PIXELS])
@pytest.mark.parametrize("at_ps", [100_000, 500_000])
def test_an_added_pulse_is_said_and_nothing_shifts(tmp_path, k, at_ps):
    scope = line()
    extra_ps = scope.pulses[k - 1][0] + at_ps // CLOCK_PS * CLOCK_PS
    scope.pulses.append([extra_ps, extra_ps + 20_000])
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert (figures["pixels"], figures["missed"], figures["extra"], figures["moved"]) == (PIXELS + 1, 0, 1, 0)
    assert any(f"extra pulse at {extra_ps} ps" in finding for finding in figures["findings"])
    assert figures["short"] == 1


@pytest.mark.parametrize("k", [1, 2, 77, 150, 299, PIXELS])
@pytest.mark.parametrize("clocks", [1, -1])
def test_a_pulse_moved_by_one_clock_is_named(tmp_path, k, clocks):
    """Also where the spread alone would not show it: the latest pulse moved early may stay within a clock."""
    scope = line()
    scope.pulses[k - 1][0] += clocks * CLOCK_PS
    scope.pulses[k - 1][1] += clocks * CLOCK_PS
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert [(m["k"], m["by_clocks"]) for m in figures["moved_pulses"]] == [(k, clocks)]
    assert (figures["missed"], figures["extra"]) == (0, 0)


def test_a_sync_moved_by_one_clock_is_named(tmp_path):
    scope = line()
    scope.sync[0][0] += CLOCK_PS
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, expect=1)
    assert [(m["k"], m["by_clocks"]) for m in figures["moved_pulses"]] == [(0, 1)]


def test_moved_pulses_are_named_without_knowing_the_clock(tmp_path):
    """An analyser with its own time base: outputs lie at no one phase, so the latencies' window decides."""
    scope = line(n=8, pixels=1000)
    drift = 1.000137                                         # its clock against ours
    scope.edges = [(round(t * drift), step) for t, step in scope.edges]
    scope.pulses = [[round(rise * drift), round(fall * drift)] for rise, fall in scope.pulses]
    scope.sync = [[round(t * drift) for t in pair] for pair in scope.sync]
    good = analyse(scope.write_vcd(tmp_path / "good.vcd"), "--n", 8)
    assert good["clock_phase_ns"] is None and good["latency_clocks"] == LATENCY
    scope.pulses[499][0] += 6000
    bad = analyse(scope.write_vcd(tmp_path / "bad.vcd"), "--n", 8, expect=1)
    assert [m["k"] for m in bad["moved_pulses"]] == [500]


def test_negative_direction(tmp_path):
    scope = line(direction=-1)
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS)
    assert figures["start_counts"] == -BEFORE
    assert figures["end_counts"] == -BEFORE - 24 * PIXELS
    assert figures["lines"][0]["direction"] == -1


def test_dithering_at_the_reference_and_in_the_line(tmp_path):
    """Going back and returning makes no progress, wherever it happens."""
    random_dither = [-1, 1] * 40 + [-1, -1, -1, 1, 1, 1] * 7
    edges = then(travel(BEFORE, MEAN_PS, 5), random_dither, 31_777)
    edges = onward(edges, travel(24 * 100, MEAN_PS, 6))      # ends exactly on pixel 100's edge
    edges = then(edges, random_dither, 23_411)
    edges = onward(edges, travel(24 * 100 - 7, MEAN_PS, 7))
    edges = then(edges, [-1] * 60 + [1] * 60, 29_333)        # back over two pixels
    edges = onward(edges, travel(24 * 100 + AFTER, MEAN_PS, 8))
    scope = Scope(edges, 24, PIXELS, [(BEFORE, 1)]).run()
    assert len(scope.pulses) == PIXELS
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS)
    assert (figures["start_counts"], figures["end_counts"]) == (BEFORE, BEFORE + 24 * PIXELS)


def test_dithering_faster_than_the_latency_with_the_least_latency_given(tmp_path):
    """Edges 12 ns apart after the reference lie before SYNC; the stated least latency excludes them."""
    edges = then(travel(BEFORE, MEAN_PS, 5), [-1, 1] * 3, 12_345)
    scope = Scope(onward(edges, travel(24 * 50 + AFTER, MEAN_PS, 6)), 24, 50, [(BEFORE, 1)]).run()
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", 50,
                      "--latency-min-ns", 50, "--latency-max-ns", 60)
    assert figures["start_counts"] == BEFORE


@pytest.mark.parametrize("n", ["24.4", "24.6", "1", "1.5", "8", "454", "2.000001"])
def test_whole_and_fractional_n(tmp_path, n):
    exact = Fraction(floor(Fraction(n) * 2**32), 2**32)
    scope = line(n=exact, pixels=100)
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", n, "--pixels", 100)
    assert figures["end_counts"] == BEFORE + ceil(100 * Fraction(n))


def test_another_n_is_not_exact(tmp_path):
    """The fraction matters: 24.4 is not taken for 24.5, though the first pulses agree."""
    exact = Fraction(floor(Fraction("24.4") * 2**32), 2**32)
    path = line(n=exact).write_vcd(tmp_path / "pins.vcd")
    assert analyse(path, "--n", "24.5", "--pixels", PIXELS, expect=1)["missed"] > 0
    raw = analyse(path, "--n", "24", "--n-fraction", hex(int(exact % 1 * 2**32)), "--pixels", PIXELS)
    assert raw["counts_per_pixel"] == pytest.approx(24.4)


def test_pixels_closer_than_the_greatest_latency(tmp_path):
    """At N = 1 and 30 ns an edge several edges may have made a pulse; the constant latency decides."""
    scope = line(n=1, pixels=500, mean_ps=30_000, width_ps=10_000)
    del scope.pulses[249]
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 1, "--pixels", 500,
                      "--latency-min-ns", 50, expect=1)
    assert figures["lines"][0]["missed_k"] == [250]
    assert (figures["extra"], figures["moved"]) == (0, 0)


def test_several_lines_both_ways(tmp_path):
    there = travel(BEFORE + 24 * 50 + AFTER, MEAN_PS, 11)
    back = travel(-(24 * 50 + 2 * AFTER), MEAN_PS, 12)
    again = travel(24 * 50 + 3 * AFTER, MEAN_PS, 13)
    end = BEFORE + 24 * 50
    scope = Scope(onward(onward(there, back), again), 24, 50,
                  [(BEFORE, 1), (end + 1, -1), (BEFORE, 1)]).run()
    path = scope.write_vcd(tmp_path / "pins.vcd")
    figures = analyse(path, "--n", 24, "--pixels", 50)
    assert figures["sync_edges"] == 3 and figures["pixels"] == 150
    assert [one["direction"] for one in figures["lines"]] == [1, -1, 1]
    assert [one["start_counts"] for one in figures["lines"]] == [BEFORE, end, BEFORE]
    del scope.pulses[50 + 20]
    figures = analyse(scope.write_vcd(path), "--n", 24, "--pixels", 50, expect=1)
    assert [one["missed_k"] for one in figures["lines"]] == [[], [21], []]


def test_serpentine_return_lines_have_their_pixels_on_the_forward_edges(tmp_path):
    """At N = 24.4 and 52 pixels the line is 1268.8 counts: the forward line ends on edge 1269, and the last pixel
    of the return line, 1268.8 counts back from there, is the forward line's reference."""
    n, pixels = Fraction(int(Fraction("24.4") * 2**32), 2**32), 52
    there = travel(BEFORE + 1269 + AFTER, MEAN_PS, 11)
    back = travel(-(1269 + 2 * AFTER), MEAN_PS, 12)
    scope = Scope(onward(there, back), n, pixels, [(BEFORE, 1), (BEFORE + 1269, -1, -(pixels * n) % 1)]).run()
    path = scope.write_vcd(tmp_path / "pins.vcd")
    figures = analyse(path, "--n", "24.4", "--serpentine", expect=0)
    assert figures["pixels"] == 2 * pixels
    forward, back = figures["lines"]
    assert (forward["start_counts"], forward["end_counts"]) == (BEFORE, BEFORE + 1269)
    assert (back["start_counts"], back["end_counts"]) == (BEFORE + 1268, BEFORE - 1)    # the same two edges
    assert analyse(path, "--n", "24.4", expect=1)["missed"] > 0


def test_missing_sync(tmp_path):
    scope = line()
    scope.sync.clear()
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, expect=1)
    assert figures["sync_edges"] == 0
    assert figures["extra"] == PIXELS
    assert "no SYNC edge" in figures["findings"][0]


def test_sync_without_an_encoder_edge(tmp_path):
    scope = line(mean_ps=4_000_000)
    scope.sync[0][0] += 2_000_000
    path = scope.write_vcd(tmp_path / "pins.vcd")
    assert analyse(path, "--n", 24, expect=1)["moved_pulses"][0]["k"] == 0       # late, where the window is not stated
    figures = analyse(path, "--n", 24, "--latency-max-ns", 1000, expect=1)
    assert "no encoder edge within 1000 ns before SYNC" in figures["findings"][0]
    assert "--latency-max-ns" in figures["findings"][0]


def by_software(n=24, pixels=PIXELS, seed=3, mean_ps=8_300_000):
    """A line whose SYNC and pulses a program makes, 3 to 9 us after their edges, on a 10 ns analyser."""
    random_ = random.Random(seed)
    scope = line(n=n, pixels=pixels, mean_ps=mean_ps)
    scope.edges = [(time_ps // 10_000 * 10_000, step) for time_ps, step in scope.edges]
    for rise_fall, late_ps in [(scope.sync[0], 4_000_000)] + [(pulse, None) for pulse in scope.pulses]:
        late_ps = random_.randint(300, 900) * 10_000 if late_ps is None else late_ps
        rise_fall[0] = (rise_fall[0] + late_ps) // 10_000 * 10_000
        rise_fall[1] = rise_fall[0] + random_.randint(900, 1100) * 10_000 if rise_fall[1] < scope.sync[0][1] else \
            rise_fall[1] + 12_000_000
    return scope


@pytest.mark.parametrize("options", [("--n", 24, "--pixels", PIXELS), ()])
def test_pulses_made_by_software_are_measured_without_options(tmp_path, capsys, options):
    """All pixels are at their edges, microseconds late: a latency and a jitter, and no pulse is moved."""
    figures = analyse(by_software().write_vcd(tmp_path / "pins.vcd"), *options, expect=1)
    assert (figures["missed"], figures["extra"], figures["moved"]) == (0, 0, 0)
    assert (figures["start_counts"], figures["end_counts"]) == (BEFORE, BEFORE + 24 * PIXELS)
    assert 3000 <= figures["latency_ns"]["min"] < 3200 and 8900 < figures["latency_ns"]["max"] < 9100
    assert figures["latency_clocks"] is None
    assert len(figures["findings"]) == 1 and "jitter" in figures["findings"][0]
    text = capsys.readouterr().out
    assert "1 finding\n" in text and "in 1 line," in text
    assert "None" not in text and "clocks" not in text and " 0 to 1" not in text


def test_software_slower_than_an_edge_is_measured_without_options(tmp_path):
    """At 6.8 mm/s an edge comes every 3.2 us, so the last one before SYNC is not SYNC's own."""
    scope = by_software(mean_ps=3_200_000)
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert (figures["missed"], figures["extra"], figures["moved"]) == (0, 0, 0)
    assert figures["start_counts"] == BEFORE and 3900 < figures["sync_latency_ns"]["min"] < 4200
    assert figures["latency_ns"]["min"] > 2900


def test_a_pulse_missing_among_those_made_by_software_is_named(tmp_path):
    scope = by_software()
    del scope.pulses[149]
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert figures["lines"][0]["missed_k"] == [150] and figures["extra"] == 0


def test_pulses_outside_the_line(tmp_path):
    scope = line()
    scope.pulses.insert(0, [scope.sync[0][0] - 700_000, scope.sync[0][0] - 650_000])
    last_ps = scope.pulses[-1][0]
    scope.pulses.append([last_ps + 1_500_000, last_ps + 1_550_000])
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert (figures["extra"], figures["missed"]) == (2, 0)
    assert sum("outside any line" in finding for finding in figures["findings"]) == 2


def test_the_pulse_after_the_last_pixel_is_extra(tmp_path):
    scope = line(pixels=PIXELS + 1)
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert (figures["extra"], figures["missed"]) == (1, 0)


def test_merged_pulses_are_told_from_missing_ones(tmp_path):
    scope = line()
    scope.pulses[99][1] = scope.pulses[100][1]               # stays high through pixel 101
    del scope.pulses[100]
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert figures["lines"][0]["missed_k"] == figures["lines"][0]["merged_k"] == [101]


def test_a_lost_count_is_said(tmp_path):
    """A and B changing together hide two counts."""
    scope = line()
    (first_ps, _), (_, step) = scope.edges[2000:2002]
    scope.edges[2001] = (first_ps, step)
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert figures["illegal_edges"] == 1
    assert any("illegal" in finding for finding in figures["findings"])


def test_a_glitch_on_a_channel_is_no_progress(tmp_path):
    """A pulse on A alone is a step and a step back, and adds no pixel."""
    scope = line()
    time_ps, step = scope.edges[3000]
    scope.edges[3001:3001] = [(time_ps + 7_000, -step), (time_ps + 12_000, step)]
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS)
    assert figures["findings"] == []


def test_file_cut_short_in_the_line(tmp_path):
    scope = line()
    path = scope.write_vcd(tmp_path / "pins.vcd", end_ps=scope.pulses[199][0] + 3_000)
    text = path.read_text()
    path.write_text(text[:-4])                               # in the middle of the last time
    figures = analyse(path, "--n", 24, "--pixels", PIXELS, expect=1)
    assert figures["pixels"] == 200 and (figures["missed"], figures["extra"]) == (0, 0)
    assert figures["findings"] == ["the file ends while SYNC is active; 100 pixels lie beyond it"]
    assert "not complete" in figures["notes"][0]


@pytest.mark.parametrize("name", ["empty.vcd", "empty.csv"])
def test_empty_file(tmp_path, capsys, name):
    path = tmp_path / name
    path.write_text("")
    assert main([str(path), "--strict"]) == 2
    assert "empty" in capsys.readouterr().err


@pytest.mark.parametrize("text, message", [
    ("hello\n", "not a value change dump"),
    ("$timescale 3 furlongs $end\n$enddefinitions $end\n", "time scale"),
    ("$timescale 1 ps $end\n$var wire 1 ! x_a $end\n$enddefinitions $end\n", "no channel 'x_b'"),
    ("$timescale 1 ps $end\n$var wire one ! x_a $end\n$enddefinitions $end\n", "header not understood"),
    (HEADER + "#0\n0!\n#soon\n", "a line is not understood"),
    (HEADER + "#20\n0!\n#10\n1!\n", "time goes backwards"),
])
def test_files_that_are_no_dump_are_refused(tmp_path, capsys, text, message):
    path = tmp_path / "bad.vcd"
    path.write_text(text)
    assert main([str(path)]) == 2
    assert message in capsys.readouterr().err


def test_an_idle_axis_is_asked_about_in_one_line(tmp_path, capsys):
    """The recording has the other axis too, which stood still."""
    path = line().write_vcd(tmp_path / "pins.vcd", names=("y_a", "y_b", "sync", "encoder"))
    text = path.read_text().replace("$upscope", "$var wire 1 x x_a $end\n$var wire 1 y x_b $end\n$upscope")
    path.write_text(text.replace("$dumpvars\n", "$dumpvars\n0x\n0y\n"))
    asked = "x_a and x_b hardly change while 299 pulses come (0 edges): is this the scanned axis"
    figures = analyse(path, "--n", 24, expect=1)
    assert len(figures["findings"]) == 1 and figures["findings"][0].startswith(asked)
    assert main([str(path)]) == 2
    assert asked in capsys.readouterr().err
    assert analyse(path, "--axis", "y")["findings"] == []


@pytest.mark.parametrize("made, given, looks", [("24", "25", "24"), ("24", "12", "24"), ("38", "24", "38")])
def test_a_wrong_n_is_told_the_n_that_the_pulses_have(tmp_path, made, given, looks):
    path = line(n=int(made)).write_vcd(tmp_path / "pins.vcd")
    assert analyse(path, "--n", given, expect=1)["findings"][0].startswith(f"the pulses look like N = {looks},")


def test_a_silent_pixel_channel_is_asked_about_in_one_line(tmp_path):
    scope = line()
    scope.pulses.clear()
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, expect=1)
    assert figures["missed"] == PIXELS
    assert figures["findings"] == [f"0 of {PIXELS} pixels have a pulse: is this the pixel clock (--pixel)?"]


def test_missing_pulses_do_not_make_another_n(tmp_path):
    scope = line()
    del scope.pulses[50:250:20]
    figures = analyse(scope.write_vcd(tmp_path / "pins.vcd"), "--n", 24, "--pixels", PIXELS, expect=1)
    assert figures["missed"] == 10 and not any("look like" in finding for finding in figures["findings"])


@pytest.mark.parametrize("options, said", [
    (("--n", "0"), "error: --n: expected a number of counts per pixel, 1 or more, not 0"),
    (("--n", "abc"), "error: --n: expected a number of counts per pixel, 1 or more, not abc"),
    (("--n", "1/0"), "error: --n: expected a number of counts per pixel, 1 or more, not 1/0"),
    (("--n-fraction", "5"), "error: --n: expected a whole number of counts per pixel, 1 or more, not nothing"),
    (("--clock-ns", "0"), "error: --clock-ns: expected a number above 0, not 0.0"),
    (("--clock-ns", "fast"), "error: argument --clock-ns: invalid float value: 'fast'"),
    (("--samplerate", "1/0"), "error: argument --samplerate: expected a number of Hz, not '1/0'"),
])
def test_senseless_options_are_refused_in_one_sentence(tmp_path, capsys, options, said):
    with pytest.raises(SystemExit) as refused:
        main([str(tmp_path / "pins.vcd"), *options])
    error = capsys.readouterr().err
    assert refused.value.code == 2
    assert error.startswith(said) and error.count("\n") == 1


def test_a_file_that_is_not_there_is_said_plainly(tmp_path, capsys):
    assert main([str(tmp_path / "none.vcd")]) == 2
    assert capsys.readouterr().err == f"{tmp_path}/none.vcd: No such file or directory\n"


def test_ctrl_c_ends_quietly(tmp_path, capsys, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt
    monkeypatch.setattr("host.jitter.cli.measure", interrupted)
    assert main([str(line(pixels=3).write_vcd(tmp_path / "pins.vcd"))]) == 130
    assert capsys.readouterr().err == "\nstopped\n"


def test_a_reader_that_has_seen_enough_is_no_error(tmp_path):
    path = line(pixels=60).write_vcd(tmp_path / "pins.vcd")
    command = f"{sys.executable} -m host.jitter {path} --n 24 | true"
    done = subprocess.run(command, shell=True, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stderr == ""


def test_wrong_channel_names_are_answered_with_the_right_ones(tmp_path, capsys):
    path = line(pixels=3).write_vcd(tmp_path / "pins.vcd", names=("ch0", "ch1", "line", "px"))
    assert main([str(path)]) == 2
    error = capsys.readouterr().err
    assert "no channel 'x_a'" in error and "top.ch0, top.ch1, top.line, top.px" in error
    analyse(path, "--a", "ch0", "--b", "top.ch1", "--sync", "line", "--pixel", "px", "--n", 24)


def test_polarity_and_reversed_encoder(tmp_path):
    scope = line(direction=-1)
    path = scope.write_vcd(tmp_path / "pins.vcd", names=("x_b", "x_a", "sync", "encoder"))
    text = path.read_text()
    for code in "#%":
        text = text.replace(f"\n0{code}", f"\n?{code}").replace(f"\n1{code}", f"\n0{code}")
        text = text.replace(f"\n?{code}", f"\n1{code}")
    path.write_text(text)
    low = ("--sync-low", "--pixel-low")
    assert analyse(path, "--n", 24, *low)["lines"][0]["direction"] == 1
    assert analyse(path, "--n", 24, "--reverse", *low)["lines"][0]["direction"] == -1


def test_bits_of_a_vector(tmp_path):
    """Channels may be bits of a bus, as in a dump of the whole top level."""
    scope = line(pixels=40)
    rows = ["$timescale 1 ps $end", "$var wire 4 a enc_a [3:0] $end", "$var wire 4 b enc_b $end",
            "$var wire 1 # sync $end", "$var wire 1 % encoder $end", "$enddefinitions $end",
            "#0", "bx a", "b0 a", "b0 b", "0#", "0%"]
    for time_ps, name, level in scope.changes():
        rows.append(f"#{time_ps}")
        rows.append({"x_a": f"b{level}01 a", "x_b": f"b{level}0x b", "sync": f"{level}#",
                     "encoder": f"{level}%"}[name])
    path = tmp_path / "pins.vcd"
    path.write_text("\n".join(rows) + "\n")
    figures = analyse(path, "--a", "enc_a[2]", "--b", "enc_b[2]", "--n", 24)
    assert figures["pixels"] == 40


def test_change_list_csv_agrees_with_the_dump(tmp_path):
    scope = line()
    dump = analyse(scope.write_vcd(tmp_path / "a.vcd"), "--n", 24)
    table = analyse(scope.write_change_csv(tmp_path / "b.csv"), "--n", 24)
    assert table == dump


def test_sampled_csv(tmp_path):
    """At 100 MS/s the file can show jitter to two samples only, and no phases; the count is still exact."""
    scope = line(n=8, pixels=60, mean_ps=200_000)
    path = scope.write_sampled_csv(tmp_path / "pins.csv", 10_000)
    figures = analyse(path, "--n", 8, "--pixels", 60)
    assert figures["resolution_ns"] == 10
    assert figures["phase_bins"] is None and "10 ns only" in figures["notes"][0]
    assert figures["jitter_ns"]["pp"] <= figures["jitter_limit_ns"] == 25
    del scope.pulses[30]
    figures = analyse(scope.write_sampled_csv(path, 10_000), "--n", 8, "--pixels", 60, expect=1)
    assert figures["lines"][0]["missed_k"] == [31]


@pytest.mark.parametrize("text, message", [
    ("time,x_a,x_b,sync,encoder\n", "no rows"),
    ("x_a,x_b,sync,encoder\n0,0,0,0\n", "no sample rate"),
    ("0,0,0,0\n0,0,0,1\n", "no header row"),
    ("time,x_a,x_b,sync\n0,0,0,0\n", "no channel 'encoder'; the file has: x_a, x_b, sync"),
    ("time,x_a,x_b,sync,encoder\n0,0,0,0,0\n1,0,up,0,0\n", "not all numbers"),
    ("time,x_a,x_b,sync,encoder\n2,0,0,0,0\n1,0,1,0,0\n", "time goes backwards"),
])
def test_tables_that_cannot_be_measured_are_refused(tmp_path, capsys, text, message):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    assert main([str(path)]) == 2
    assert message in capsys.readouterr().err


def test_phases_that_are_not_spread_are_said(tmp_path):
    """A stage in step with the clock would hide the jitter."""
    scope = line()
    scope.edges = [(time_ps // CLOCK_PS * CLOCK_PS + 2000, step) for time_ps, step in scope.edges]
    scope.pulses.clear()
    scope.sync.clear()
    figures = analyse(scope.run().write_vcd(tmp_path / "pins.vcd"), "--n", 24)
    assert figures["phase_bins_spread"] is False
    assert figures["jitter_ns"]["pp"] == 0


def test_runs_as_a_module_and_draws(tmp_path):
    path = line(pixels=60).write_vcd(tmp_path / "pins.vcd")
    picture = tmp_path / "scan.png"
    done = subprocess.run([sys.executable, "-m", "host.jitter", str(path), "--n", "24", "--plot", str(picture)],
                          cwd=ROOT, capture_output=True, text=True, check=True)
    assert "60 pixel pulses in 1 line, N = 24 (given): exact" in done.stdout
    assert "3 to 10 us by analogy" in done.stdout
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n" and picture.stat().st_size > 20_000
