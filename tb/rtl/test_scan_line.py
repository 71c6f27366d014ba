# SPDX-License-Identifier: BSD-2-Clause
"""rtl/line.py, ScanLine: steps in, pins out, clock by clock, against the scenario tables and the model."""

import random

import cocotb
import pytest

from rtl.line import LINE_LATENCY, ScanLine
from tb.models.line import Line, Step, expect, pulses
from tb.rtl import line_bench
from tb.rtl.line_bench import Bench, command, live, play, report_fields, to_line
from tb.vectors import ROUTES, load

SCENARIOS = {(block, s.name): s for block in ("compare", "divider", "router") for s in load(block)}


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(key=list(SCENARIOS))
async def plays_the_scenario(dut, key):
    await play(dut, SCENARIOS[key])


def wander(random_, clocks, start, goal, *, rate=1.0, back=0.1):
    """Steps of one axis, by clock, that tend from ``start`` to ``goal`` with reversals on the way."""
    position, toward, moves, retreat = start, 1 if goal > start else -1, {}, 0
    for clock in range(clocks):
        if position == goal or random_.random() >= rate:
            continue
        if not retreat and random_.random() < back:
            retreat = random_.choice((1, 1, 2, 3, 5, 8, 40))
        move = -toward if retreat else toward
        retreat = max(0, retreat - 1)
        moves[clock] = move
        position += move
    return moves


async def run_line(dut, setup, moves, clocks, *, armed=2):
    """Scan one line clock by clock; compare pins and report with the model."""
    start = {axis: setup.get(f"start{axis}", 0) for axis in range(4)}
    bench = Bench(dut, start)
    await bench.start(live(ROUTES, **setup))
    steps = [Step(clock, axis, move) for axis, path in moves.items() for clock, move in path.items()]
    line = to_line(setup)
    expected = expect(line, steps, start=start, armed=armed)
    triggers = expected.pixels if setup.get("emit", 1) else []
    levels, merged = pulses(triggers, setup.get("width", 1))

    sync, encoder = [], []
    for clock in range(clocks):
        seen = await bench.tick({axis: path[clock] for axis, path in moves.items() if clock in path},
                                command(arm=1, **setup) if clock == armed else None)
        sync.append(seen["sync"])
        encoder.append(seen["encoder"])

    want_sync, want_encoder = [0] * clocks, [0] * clocks
    if expected.rise is not None:
        fall = clocks if expected.fall is None else expected.fall
        line_bench.fill(want_sync, expected.rise + LINE_LATENCY, fall + LINE_LATENCY)
    for rise, fall in levels:
        line_bench.fill(want_encoder, rise + LINE_LATENCY - 1, fall + LINE_LATENCY - 1)
    for name, got, want in ("SYNC", sync, want_sync), ("pixel", encoder, want_encoder):
        if got != want:
            clock = next(n for n, pair in enumerate(zip(got, want)) if pair[0] != pair[1])
            raise AssertionError(f"{name} is {got[clock]} in clock {clock}; {setup}")
    report = report_fields(seen["report"])
    assert report["produced"] == len(expected.pixels)
    assert report["end_position"] == (expected.end_position + 2**31) % 2**32 - 2**31
    assert report["merged"] == merged
    assert report["late"] == expected.late
    return expected


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(n=["1", "1.5", "1.99999", "2", "8", "24", "24.4", "38", "255", "256", "257", "454"],
                    reverse=[0, 1])
async def pixels_come_at_the_progress_of_the_recurrence(dut, n, reverse):
    random_ = random.Random(f"{n} {reverse}")
    exact = int(float(n) * 2**32)
    whole, fraction = divmod(exact, 2**32)
    pixels = max(3, min(60, 1500 // whole))
    sign = -1 if reverse else 1
    setup = {"whole": whole, "fraction": fraction, "phase": random_.choice((0, 2**31, 2**32 - 1)),
             "pixels": pixels, "reverse": reverse, "reference": 1000 * sign, "start0": 990 * sign,
             "width": random_.choice((1, 2, 5))}
    goal = (1000 + pixels * (whole + 1) + 20) * sign
    clocks = int(1.9 * (pixels * (whole + 1) + 30)) + 300
    moves = wander(random_, clocks - 30, setup["start0"], goal, back=0.02)
    expected = await run_line(dut, setup, {0: moves}, clocks)
    assert len(expected.pixels) >= 2


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(seed=range(24))
async def any_line_with_dithering_and_reversals(dut, seed):
    random_ = random.Random(seed)
    reverse, axis, pixel_axis = random_.randrange(2), random_.randrange(4), random_.randrange(4)
    if random_.random() < 0.5:
        pixel_axis = axis
    sign = -1 if reverse else 1
    reference = random_.choice((0, 1, -1, 2**31 - 1, -2**31, random_.randrange(-2**31, 2**31)))
    setup = {"whole": random_.choice((1, 1, 2, 3, 7, 20)), "fraction": random_.choice((0, random_.randrange(2**32))),
             "phase": random_.randrange(2**32), "pixels": random_.randrange(1, 12), "reverse": reverse,
             "axis": axis, "pixel_axis": pixel_axis, "reference": reference,
             "width": random_.randrange(1, 9), "emit": int(random_.random() < 0.9)}
    clocks = 1200
    setup[f"start{axis}"] = reference - sign * random_.randrange(0, 4)
    if pixel_axis != axis:
        setup[f"start{pixel_axis}"] = random_.randrange(-2**31, 2**31)
    moves = {}
    for n in {axis, pixel_axis}:
        start = setup[f"start{n}"]
        moves[n] = wander(random_, clocks - 30, start, start + sign * 400, rate=random_.choice((0.3, 0.9, 1)),
                          back=random_.choice((0, 0.05, 0.4)))
    dut._log.info("seed %d: %s", seed, setup)
    await run_line(dut, setup, moves, clocks)


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def ground_lost_by_hundreds_of_counts_is_not_counted_again(dut):
    # Far enough behind for every carry of the distance, with dithering around them.
    random_ = random.Random(1)
    moves, clock = {}, 6
    for target in (20, -600, -470, -600, -380, 10, 30, -120, -130, -126, -131, 40):
        position = sum(moves.values())
        while position != target:
            move = 1 if target > position else -1
            moves[clock] = move
            position += move
            clock += 1
            if random_.random() < 0.2:
                moves[clock], moves[clock + 1] = -move, move
                clock += 2
    setup = {"start0": -1, "reference": 0, "whole": 3, "pixels": 12}
    assert len((await run_line(dut, setup, {0: {c: m for c, m in moves.items()}}, clock + 30)).pixels) == 12


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(offset=[-2**31, -2**31 + 1, -2, -1, 0, 1, 2, 2**31 - 1], reverse=[0, 1])
async def late_means_at_or_past_the_reference(dut, offset, reverse):
    setup = {"reference": 77, "start0": 77 + offset, "reverse": reverse, "whole": 9}
    await run_line(dut, setup, {}, 20)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(gap=range(1, 10))
async def pulses_keep_their_width_down_to_a_gap_of_one_clock(dut, gap):
    # A step every (width + gap - 4) clocks: merged while the gap is not positive.
    width = 5
    moves = {6 + n * (width + gap - 4): 1 for n in range(9)}
    await run_line(dut, {"start0": -1, "reference": 0, "pixels": 8, "width": width}, {0: moves}, 150)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_new_width_is_taken_at_the_next_pulse(dut):
    bench = Bench(dut, {0: -1})
    await bench.start(live(ROUTES, width=300))
    pins = []
    for clock in range(800):
        # Width changes to 1 while the first pulse is high; pixels at clocks 7 and 400.
        bits = live(ROUTES, width=1) if clock == 100 else None
        pins.append((await bench.tick({0: 1} if clock in (6, 7, 400) else {},
                                      command(arm=1, pixels=9) if clock == 0 else None, bits))["encoder"])
    assert [n for n in range(1, 800) if pins[n] != pins[n - 1]] == [14, 314, 407, 408]


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(armed=[13, 14, 15, 16])
async def a_pulse_of_the_line_before_is_not_merged_into_the_next(dut, armed):
    bench = Bench(dut, {0: -1})
    await bench.start(live(ROUTES, width=9))
    merged = []
    for clock in range(30):
        seen = await bench.tick({0: 1} if clock >= 6 else {},
                                command(arm=1, pixels=99) if clock in (0, armed) else None)
        merged.append(report_fields(seen["report"])["merged"])
    assert merged[armed] > 0                            # one step and one pulse per clock until then
    assert merged[armed + 2:] == [0] * (28 - armed)     # the second arming is late: no pulses at all


def test_pins(simulate):
    simulate(ScanLine())


@pytest.mark.parametrize("block", ["compare", "divider"])
def test_tables_agree_with_the_model(block):
    checked = 0
    for scenario in load(block):
        strobes = [key for given in scenario.inputs.values() for key in ("arm", "disarm") if key in given]
        if strobes != ["arm"]:
            continue
        for name, levels in line_bench.model_of(scenario).items():
            assert scenario.outputs[name] == levels, f"{scenario.name}: {name}"
        checked += 1
    assert checked >= 4


def test_the_model_places_pixels_by_its_definition():
    line = Line(reference=0, whole=24, fraction=int(0.4 * 2**32), phase=2**32 - 1, pixels=3)
    assert [line.pixel_progress(k) for k in (1, 2, 3, 5)] == [25, 49, 74, 122]
