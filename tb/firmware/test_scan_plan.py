# SPDX-License-Identifier: BSD-2-Clause
"""The scan planner against exact fractions: the same settings as decimals, by an arithmetic that shares nothing with it."""
import ctypes
import math
import os
import pathlib
import random
import subprocess
from fractions import Fraction

import pytest

ROOT = pathlib.Path(__file__).parents[2]
FAST_HZ = 200_000_000
MARGIN = 16
OK, NO_LENGTH, PITCH, NO_PIXELS, SPEED, RANGE, WIDTH = range(7)


class Settings(ctypes.Structure):
    _fields_ = [("start_mm", ctypes.c_double), ("stop_mm", ctypes.c_double), ("pixels", ctypes.c_uint32),
                ("pitch_counts", ctypes.c_double), ("width_us", ctypes.c_double), ("settle_ms", ctypes.c_double),
                ("overshoot_mm", ctypes.c_double)]


class Axis(ctypes.Structure):
    _fields_ = [("counts_per_mm", ctypes.c_double), ("speed_mm_per_s", ctypes.c_double),
                ("speed_max_mm_per_s", ctypes.c_double), ("accel_ms", ctypes.c_double),
                ("start_count", ctypes.c_int32), ("mirrored", ctypes.c_bool), ("fast_clock_hz", ctypes.c_uint32)]


class Line(ctypes.Structure):
    _fields_ = [("reference_edge", ctypes.c_int32), ("reverse", ctypes.c_bool), ("phase", ctypes.c_uint32),
                ("end_count", ctypes.c_int32), ("from_count", ctypes.c_int32), ("to_count", ctypes.c_int32)]


class Plan(ctypes.Structure):
    _fields_ = [("forward", Line), ("back", Line), ("pixels", ctypes.c_uint32), ("pitch_whole", ctypes.c_uint32),
                ("pitch_fraction", ctypes.c_uint32), ("width_fast", ctypes.c_uint32),
                ("interval_min_fast", ctypes.c_uint32)]


@pytest.fixture(scope="module")
def library():
    """The planner as the host build compiles it, in a shared object."""
    out = ROOT / "build" / "host" / "scan_plan.so"
    out.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run([os.environ.get("CC", "gcc"), "-std=c11", "-O1", "-Wall", "-Wextra", "-Wconversion", "-Werror",
                    "-ffp-contract=off", "-fsanitize=undefined", "-fno-sanitize-recover=all", "-static-libubsan",
                    "-shared", "-fPIC", "-I", ROOT / "firmware", "-o", out, ROOT / "firmware/modules/scan_plan.c", "-lm"], check=True)
    lib = ctypes.CDLL(str(out))
    lib.scan_plan_pixels.restype = ctypes.c_uint32
    lib.scan_plan_pixels.argtypes = [ctypes.POINTER(Settings), ctypes.c_double]
    lib.scan_plan_stop_mm.restype = ctypes.c_double
    lib.scan_plan_stop_mm.argtypes = [ctypes.POINTER(Settings), ctypes.c_double]
    return lib


def settings(start="0", stop="1", pixels=0, pitch="24", width="0", settle="0", overshoot="0"):
    return Settings(float(start), float(stop), pixels, float(pitch), float(width), float(settle), float(overshoot))


def axis(counts_per_mm="45396", speed="0.528", maximum="6.8", accel="50", start_count=0, mirrored=False):
    return Axis(float(counts_per_mm), float(speed), float(maximum), float(accel), start_count, mirrored, FAST_HZ)


def make(library, a, b):
    plan = Plan()
    return library.scan_plan_make(ctypes.byref(a), ctypes.byref(b), ctypes.byref(plan)), plan


def pixel_edge(line, k, pitch_q32):
    """Absolute edge of pixel k, by the divider's rule on what the plan would load."""
    progress = (k * pitch_q32 + line.phase) >> 32
    return line.reference_edge + (-progress if line.reverse else progress)


@pytest.mark.parametrize("pitch, pixels", [("24", 1891), ("38", 1194), ("454", 99), ("24.4", 1860), ("1", 45396)])
def test_millimetre_of_the_default_stage(library, pitch, pixels):
    status, plan = make(library, settings(pitch=pitch), axis())
    assert (status, plan.pixels) == (OK, pixels)


@pytest.mark.parametrize("start, stop, counts, pitch", [
    ("0.1", "0.3", "45396", "9079.2"),      # 0.3 - 0.1 is below 0.2 in binary
    ("0", "0.7", "10000", "70"),
    ("-0.2", "0.1", "30000", "0.9"),
    ("0", "0.1", "181590.4", "18159.04"),
    ("0", "1", "45396", "24.6"),
])
def test_decimals_that_divide_exactly_lose_no_pixel(library, start, stop, counts, pitch):
    status, plan = make(library, settings(start, stop, pitch=pitch), axis(counts))
    if Fraction(pitch) < 1:
        assert status == PITCH
        return
    assert status == OK
    assert plan.pixels == Fraction(counts) * (Fraction(stop) - Fraction(start)) // Fraction(pitch)


def decimal(rng, low, high, digits):
    """A random decimal with so many digits behind the point, as text and as the exact number."""
    text = f"{rng.uniform(low, high):.{rng.randint(0, digits)}f}"
    return text, Fraction(text)


def test_random_lines_agree_with_exact_fractions(library):
    seed = int(os.environ.get("SEED", random.randrange(1 << 32)))
    print("seed", seed)
    rng = random.Random(seed)
    planned = 0
    for _ in range(1000):
        start, start_mm = decimal(rng, -60, 60, 6)
        length, length_mm = decimal(rng, -0.5, 0.5, 6)
        stop = f"{float(start_mm + length_mm):.6f}"
        stop_mm = Fraction(stop)
        counts, k = decimal(rng, 100, 200000, 4)
        pitch, n = decimal(rng, 0.5, rng.choice([3, 30, 3000]), 4)  # exact up to 2**32 / 10**4 pixels
        start_count = rng.randint(-(1 << 30), 1 << 30)
        mirrored = rng.random() < 0.5
        status, plan = make(library, settings(start, stop, pitch=pitch),
                            axis(counts, maximum="1e-3", speed="1e-3", start_count=start_count, mirrored=mirrored))
        if n < 1:
            assert status == PITCH
            continue
        pixels = k * abs(stop_mm - start_mm) // n
        if stop_mm == start_mm:
            assert status == NO_LENGTH
            continue
        if pixels == 0:
            assert status == NO_PIXELS
            continue
        assert (status, plan.pixels) == (OK, pixels), (start, stop, counts, pitch)
        planned += 1

        up = (stop_mm > start_mm) != mirrored
        step = 1 if up else -1
        line = plan.forward
        assert line.reverse == (not up)
        assert line.reference_edge == (start_count if up else start_count + 1)
        assert line.end_count == start_count + step * math.ceil(pixels * n)

        # Pixel k on the edge where k whole pitches are complete, the decimal pitch, not its binary neighbour.
        pitch_q32 = (plan.pitch_whole << 32) | plan.pitch_fraction
        some = sorted({0, 1, 2, pixels - 1, pixels, *(rng.randint(0, pixels) for _ in range(100))} & {*range(pixels + 1)})
        edges = {k: line.reference_edge + step * math.ceil(k * n) for k in some}
        assert all(pixel_edge(line, k, pitch_q32) == edges[k] for k in some if k > 0)
        # The way back: SYNC at the last edge, then the same edges, down to the forward line's reference.
        back = plan.back
        assert back.reverse == up
        assert back.reference_edge == edges[pixels]
        assert all(pixel_edge(back, pixels - k, pitch_q32) == edges[k] for k in some if k < pixels)
        assert back.end_count == (line.reference_edge - 1 if up else line.reference_edge)
        # Armed before the reference, at rest beyond the end.
        assert step * (start_count - line.from_count) >= MARGIN and step * (line.to_count - line.end_count) >= MARGIN
        assert (back.from_count, back.to_count) == (line.to_count, line.from_count)
    assert planned > 300


def test_mirrored_axis_has_the_same_pixels(library):
    for stop in ("1", "-1"):
        plans = [make(library, settings(stop=stop, pitch="24.4"), axis(mirrored=m))[1] for m in (False, True)]
        assert plans[0].pixels == plans[1].pixels == 1860
        assert plans[0].forward.reverse != plans[1].forward.reverse


def test_number_of_pixels_replaces_the_stop(library):
    status, plan = make(library, settings(stop="0", pixels=1000, pitch="24.4"), axis(start_count=5))
    assert (status, plan.pixels, plan.forward.end_count) == (OK, 1000, 5 + 24400)
    status, plan = make(library, settings(stop="-3", pixels=1000, pitch="24.4"), axis(start_count=5))
    assert (status, plan.forward.reverse, plan.forward.end_count) == (OK, True, 5 - 24400)
    assert library.scan_plan_stop_mm(settings(start="1", pixels=1000, pitch="24"), 45396.0) == 1 + 24000 / 45396
    assert library.scan_plan_pixels(settings(), 45396.0) == 1891


def test_run_up_holds_ramp_settling_and_overshoot(library):
    # 0.528 mm/s, 50 ms: 13.2 um = 599.2 counts; 10 ms of settling: 239.7; 0.01 mm: 453.96.
    _, plan = make(library, settings(settle="10", overshoot="0.01"), axis())
    way = math.ceil(Fraction("45396") * (Fraction("0.528") * (25 + 10) / 1000 + Fraction("0.01"))) + MARGIN
    assert abs(plan.forward.from_count + way) <= 1
    assert abs(plan.forward.to_count - (1891 * 24 + way)) <= 1


@pytest.mark.parametrize("pitch, speed, maximum, clocks", [
    ("24", "0.528", "6.8", 2000),           # 10 us
    ("24", "6.8", "6.8", 2000),             # half a pixel would be 38.9 us
    ("4", "6.8", "6.8", 1295),              # half a pixel: 4 / (2 * 6.8 * 45396) s = 6.48 us
    ("2", "0.528", "6.8", 1293),            # half a pixel is more, but at full speed 2 clocks must stay low
    ("1.5", "0.528", "6.8", 645),           # the shortest pixel is one count
])
def test_default_pulse_width(library, pitch, speed, maximum, clocks):
    status, plan = make(library, settings(pitch=pitch), axis(speed=speed, maximum=maximum))
    assert (status, plan.width_fast) == (OK, clocks)
    assert plan.interval_min_fast == int(math.floor(Fraction(pitch)) * FAST_HZ / (Fraction(maximum) * 45396))
    assert plan.width_fast + 2 <= plan.interval_min_fast


def test_pulse_width_as_set_is_refused_when_pulses_would_merge(library):
    interval = int(24 * FAST_HZ / (Fraction("6.8") * 45396))         # 15549 clocks = 77.745 us
    assert make(library, settings(width="0.05"), axis())[1].width_fast == 10
    assert make(library, settings(width=str((interval - 2) / 200)), axis())[1].width_fast == interval - 2
    assert make(library, settings(width=str((interval - 1) / 200)), axis())[0] == WIDTH
    assert make(library, settings(width="0.002"), axis())[0] == WIDTH  # rounds to no clock at all


@pytest.mark.parametrize("change, status", [
    (dict(stop="0"), NO_LENGTH),
    (dict(pitch="0"), PITCH), (dict(pitch="0.999"), PITCH), (dict(pitch="nan"), PITCH), (dict(pitch="3e9"), PITCH),
    (dict(pitch="50000"), NO_PIXELS),
    (dict(stop="47306"), RANGE), (dict(stop="1e300"), RANGE), (dict(start="-inf"), RANGE),
    (dict(pixels=1 << 31), RANGE), (dict(settle="1e12"), RANGE), (dict(stop="900000", pitch="2e9"), RANGE),
])
def test_impossible_lines_are_refused(library, change, status):
    assert make(library, settings(**change), axis())[0] == status


def test_lines_at_the_ends_of_the_counts_are_refused(library):
    assert make(library, settings(), axis(start_count=(1 << 31) - 1))[0] == RANGE
    assert make(library, settings(), axis(start_count=-(1 << 31)))[0] == RANGE
    assert make(library, settings(), axis(speed="0"))[0] == SPEED
