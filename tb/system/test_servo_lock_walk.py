# SPDX-License-Identifier: BSD-2-Clause
"""SERVOLOCK_TTL on the whole controller: how long from a pulse to the motor, and that none of them is lost.

A short pulse is decided by its falling edge, a long one at the threshold. From there two servo periods are the bound: up to
one until a tick takes the decision, and one from a tick to its duties.
"""

import random

import pytest

from tb.sim.simulator import MS, SIGNALS, US

NS = US // 1000
TICK_US = 100
BOUND_US = 2 * TICK_US
PULSES = 8                              # for each kind, at any phase of the tick
COUNTS_PER_UM = 45.396


def ask(sim, line):
    reply = sim.command(line)
    assert reply.startswith(":A"), (line, reply)
    return reply


def letters(reply):
    """``{letter: number}`` of ``:A X=1 Y=2``."""
    return {word[0]: float(word[2:]) for word in reply.split()[1:]}


def pulse(sim, at_ps, length_ps):
    sim.schedule_input(at_ps, "in0", 1)
    sim.schedule_input(at_ps + length_ps, "in0", 0)


def rest(sim):
    """Run until X has settled: its drive is off."""
    for _ in range(30):
        sim.record("x_pwm")
        sim.run(10 * MS)
        driven = len(sim.changes())
        sim.record()
        if not driven:
            return
    raise AssertionError("still driven after 300 ms")


def first_drive_us(sim, at_ps, length_ps, decided_ps):
    """From the decision on a pulse to the first rise of X's PWM pin."""
    pwm = SIGNALS.index("x_pwm")
    sim.record("x_pwm", "in0")
    pulse(sim, at_ps, length_ps)
    sim.run(at_ps + 2 * MS - sim.time_ps)
    changes = sim.changes()
    sim.record()
    driven = changes[(changes["signal"] == pwm) & (changes["level"] == 1)]["time_ps"]
    assert len(driven), "no drive within 2 ms"
    assert driven[0] > decided_ps, "driven before the decision"
    return (int(driven[0]) - decided_ps) / US


@pytest.mark.parametrize("kind, compatible", [("short", 0), ("long", 0), pytest.param("short", 1, marks=pytest.mark.slow)])
def test_a_decision_drives_within_two_servo_periods(powered, kind, compatible):
    phase = random.Random(f"{kind} {compatible}")
    threshold_us = 20
    for line in ("R X=30 Y=0", f"RT R={threshold_us / 1000}", f"LK S={compatible}"):
        ask(powered, line)
    ask(powered, "LK F=84")
    took_us = []
    for _ in range(PULSES):
        rest(powered)
        length_ps = phase.randrange(US, 19 * US) if kind == "short" else phase.randrange(21 * US, 80 * US)
        at_ps = powered.time_ps + phase.randrange(50 * US, 150 * US)
        decided_ps = at_ps + (length_ps if kind == "short" and not compatible else threshold_us * US)
        took_us.append(first_drive_us(powered, at_ps, length_ps, decided_ps))
    print(f"{kind} pulse{', decided at the threshold' * compatible}: decision to first duty {min(took_us):.1f} to "
          f"{max(took_us):.1f} us")
    assert 0 < min(took_us) and max(took_us) <= BOUND_US
    assert letters(ask(powered, "LK N? C? L?")) == {"N": PULSES, "C": 0, "L": 0}


def test_the_threshold_has_no_undecided_band(powered):
    """The default of 0.75 ms, half a microsecond to either side: what the original leaves open for 250 us."""
    ask(powered, "LK F=84")
    before = letters(ask(powered, "M X?"))["X"]
    ask(powered, "R X=10 Y=0")
    for length_us, moved in ((600, 10), (749.99, 20), (750.01, 10), (749.99, 20), (750.01, 10), (1000, 0)):
        pulse(powered, powered.time_ps + 100 * US, round(length_us * US))
        powered.run(2 * MS)
        assert letters(ask(powered, "M X?"))["X"] == pytest.approx(before + moved, abs=0.3), length_us


def test_a_burst_waits_its_turn(powered):
    """500 pulses at 500 kHz, each a step of all four axes, at their fences all the time: the servo has its time, and nothing is lost."""
    for line in ("RM Y=15", "RT R=0.001", "LR Z=0.001", "LK R=7", "LK F=84"):
        ask(powered, line)
    start_ps, wanted, clipped = powered.time_ps + MS, 0, 0
    for n in range(500):
        long = n % 3 == 2
        pulse(powered, start_ps + n * 2 * US, 1100 * NS if long else 500 * NS)
        wanted += -7 if long else 7
        clipped += abs(wanted) > 10
        wanted = max(-10, min(10, wanted))
    powered.run(16 * MS)
    assert letters(ask(powered, "LK N? C? L?")) == {"N": 500, "C": clipped, "L": 0}
    for axis in "XYZF":
        assert letters(ask(powered, f"M {axis}?"))[axis] == pytest.approx(wanted, abs=0.6), axis
    last, longest = ask(powered, "TICK").split()[1:]
    print(f"500 pulses at 500 kHz, four axes; longest servo interrupt {longest} clocks")
    assert int(longest) < 5000 and "48" not in powered.command("DU Y").split(), "a servo tick was missed"


def test_no_pulse_is_lost_at_100_khz_while_a_host_asks(powered):
    """2000 random pulses, 10 us apart, at the fence every now and then; 40 of them late, close behind another."""
    rng = random.Random(7)
    for line in ("RT R=0.003", "LR Z=0.003", "R X=1.7 Y=-7.3", "VB Z=3"):
        ask(powered, line)
    powered.run(100 * MS)
    ask(powered, "LK F=84")
    origin = {axis: round(letters(ask(powered, f"M {axis}?"))[axis] / 10 * COUNTS_PER_UM) for axis in "XY"}
    at, step = dict(origin), {"X": 0.17 * COUNTS_PER_UM, "Y": -0.73 * COUNTS_PER_UM}
    ends = {axis: (origin[axis] - 3 * COUNTS_PER_UM, origin[axis] + 3 * COUNTS_PER_UM) for axis in "XY"}
    clipped, start_ps = 0, powered.time_ps + MS
    powered.serial_read()
    powered.serial_write(b"W X Y Z F\r" * 20)
    for n in range(2000):
        long = rng.random() < (0.25 if n // 100 % 2 else 0.75)
        late_ps = rng.randrange(4 * US) if n % 50 == 0 else rng.randrange(1000)
        pulse(powered, start_ps + n * 10 * US + late_ps, rng.randrange(3100, 5500) * NS if long
              else rng.randrange(200, 2900) * NS)
        cut = False
        for axis in "XY":
            at[axis] += -step[axis] if long else step[axis]
            low, high = ends[axis]
            cut |= not low - 1e-6 <= at[axis] <= high + 1e-6
            at[axis] = min(max(at[axis], low), high)
        clipped += cut
    powered.run(22 * MS)
    for _ in range(20):                     # the rest of the replies
        if not powered.serial_read():
            break
        powered.run(10 * MS)
    else:
        raise AssertionError("replies without an end")
    assert letters(ask(powered, "LK N? C? L?")) == {"N": 2000, "C": clipped, "L": 0}
    assert 200 < clipped < 1800
    for axis in "XY":
        told = letters(ask(powered, f"M {axis}?"))[axis] / 10 * COUNTS_PER_UM
        assert told == pytest.approx(at[axis], abs=1.01), axis      # the count below
    last, longest = ask(powered, "TICK").split()[1:]
    print(f"2000 pulses at 100 kHz, {clipped} clipped; longest servo interrupt {longest} clocks")
    assert int(longest) < 4000 and "48" not in powered.command("DU Y").split(), "a servo tick was missed"
