# SPDX-License-Identifier: BSD-2-Clause
"""Whole scans on the virtual controller, far faster than in real time, and every pulse of sampled lines by arithmetic.

The firmware and the model of the gateware are those of ``make twin``; what must come out is in :mod:`tb.twin.scans`.
``make test-slow`` (``FULL_LINES=1``) scans the whole field of the original's manual, 1891 lines of 1891 pixels.
"""

import hashlib
import os

import pytest

from tb.twin import figures
from tb.twin.scans import TICK_CLOCKS, Field, exact, run

FAST_HZ = 200_000_000
FULL = "FULL_LINES" in os.environ


def hash_of(times):
    return hashlib.sha256(b"".join(t.to_bytes(8, "little") for t in times)).hexdigest()


def judge(field):
    lines, sampled, errors, stray, simulated_s, processor_s = run(field, None if FULL else 120)
    assert errors == [] and stray == 0
    assert len(lines) == field.lines
    assert {pulses for _, _, pulses, _, _ in lines} == {field.pixels()}
    # SYNC falls with the last pixel; a line lasts as long as its way at its speed, to a clock.
    way = field.edges(0)[-1] * 2**32 * TICK_CLOCKS / field.step_q32()
    assert all(end == last and abs(end - sync - way) <= 1 for sync, end, _, _, last in lines)
    assert all(a[1] < b[0] for a, b in zip(lines, lines[1:]))
    for number, pulses in sampled.items():
        sync = lines[number][0]
        times = exact(field, number, sync, pulses)
        assert times is not None, f"line {number}: no phase fits"
        assert hash_of(times) == hash_of([sync, *pulses]), f"line {number}"
    print(f"{field.lines} lines of {field.pixels()} pixels, {len(sampled)} of them pulse by pulse: {simulated_s:.1f} s "
          f"in {processor_s:.2f} s of a processor, {simulated_s / processor_s:.0f} times real time")
    return sampled


FIELDS = {
    "raster": Field(),
    "serpentine": Field(serpentine=True),
    "serpentine, N = 24.4": Field(serpentine=True, n="24.4"),
    "serpentine, N = 38, faster": Field(serpentine=True, n="38", speed="2.5"),
    "raster, from a negative start": Field(start="-0.5", lines=3),
    "N = 1": Field(n="1", length="0.05", speed="0.1"),
}


@pytest.mark.parametrize("name", FIELDS)
def test_every_pulse_of_a_scan_is_the_exact_one(name):
    assert len(judge(FIELDS[name])) == FIELDS[name].lines


@pytest.mark.parametrize("serpentine", [False, True])
def test_the_field_of_the_manual(serpentine):
    """1891 lines and 20 of them pulse by pulse; in the ordinary suite its first 40 lines and all of them."""
    field = Field(lines=1891, width="1.0", serpentine=serpentine, every=95) if FULL else \
        Field(lines=40, width=f"{40 / 1891:.6f}", serpentine=serpentine)
    assert field.pixels() == 1891
    assert len(judge(field)) == (20 if FULL else 40)


@pytest.mark.parametrize("serpentine, settings, seconds", [
    (True, (), 2.029), (False, (), 2.311), (False, ("SCANR R=100",), 2.236),
], ids=["serpentine", "raster", "raster, way back at full speed"])
def test_a_line_and_the_way_back_take_their_time(serpentine, settings, seconds):
    """From one SYNC to the next in the field of the manual.  1.893 s are the line's; twice 10 ms of settling, four ramps of 50 ms
    (half of each is way at the speed of the line) and the step of the slow axis come to it, and 1 mm back at 4.6 or 6.8 mm/s."""
    lines, *_ = run(Field(lines=5, width=f"{5 / 1891:.6f}", serpentine=serpentine, settings=settings, every=5), 120)
    syncs = [line[0] for line in lines]
    # A serpentine's lines begin at either end: two of them are a round.
    round_s = (syncs[3] - syncs[1]) / 2 / FAST_HZ
    assert round_s == pytest.approx(seconds, abs=2e-3)
    print(f"{round_s:.4f} s a line, {round_s * 1891 / 3600:.3f} h for 1891")


def test_a_pulse_that_is_a_clock_late_is_seen():
    field = Field(lines=1)
    lines, sampled, *_ = run(field)
    pulses = sampled[0]
    assert exact(field, 0, lines[0][0], pulses) is not None
    moved = [t + (k == 1000) for k, t in enumerate(pulses)]
    # Within the freedom of the phase, a few clocks in a million, one clock cannot hide.
    found = exact(field, 0, lines[0][0], moved)
    assert found is None or hash_of(found) != hash_of([lines[0][0], *moved])


def test_the_figure_of_the_manual_is_up_to_date():
    assert figures.PATH.read_text() == figures.render(), "stale: python -m tb.twin.figures"
