# SPDX-License-Identifier: BSD-2-Clause
"""``make bench-timing``: every figure of the timing modules, measured by running them, beside the original's.

Each comes from pulses that go into and out of the pins of the Verilated controller with its firmware. Prints a table, and writes
``build/bench/timing.json`` and ``build/bench/timing.png``. Ends with 1 when a figure does not beat the original's.
``originals.toml`` says where those are from.
"""

import argparse
import contextlib
import json
import random
import sys
import tempfile
import tomllib
from pathlib import Path

from tb.bench.__main__ import DIRECTORY
from tb.demo.__main__ import run as scan
from tb.demo.scenario import Scenario
from tb.sim import controller
from tb.sim.simulator import FAST_PERIOD_PS, MS, SYNC_PERIOD_PS, US
from tb.system import test_led_walk as light
from tb.system import test_trigger_walk as trigger
from tb.system import test_ttl_report_walk as report

ORIGINALS = Path(__file__).with_name("originals.toml")


def power_up():
    sim = controller.build().power_up()
    sim.run(20 * MS)
    tell(sim, "/", "N")
    return sim


def tell(sim, line, answer=":A "):
    said = sim.command(line)
    if said != f"{answer}\r\n":
        raise RuntimeError(f"{line} is answered {said!r}")


# --- Measurements: each gives the figures that it is named for in MEASUREMENTS ---------------------------------------------

def measure_scan():
    """A line of 0.15 mm at the manual's 24 counts, and one of single counts near the stage's full speed."""
    # Which tell what they send; here that would stand in the table.
    with tempfile.TemporaryDirectory() as directory, contextlib.redirect_stdout(None):
        line = scan(Scenario(stop="0.15"), Path(directory))
        single = scan(Scenario(stop="0.2", n="1", speed="6.0"), Path(directory))
    if line["failures"] or single["failures"]:
        raise RuntimeError(f"the lines are not exact: {line['failures'] + single['failures']}")
    return (line["latency_ns"]["max"] / 1e3, line["jitter_ns"]["pp"] / 1e3, line["sync_latency_ns"]["max"] / 1e3,
            single["counts_per_pixel"], single["pixel_rate_hz"] / 1e3, line["following_error_counts"]["rms"])


def measure_trigger():
    """TTL X=2 repeats a distance: from IN0 to the first pulse at the motor, at ten phases of the servo."""
    rng = random.Random(1)
    with power_up() as sim:
        for line in "S Z=1", "AC Z=20", "R X=0 Z=20", "TTL X=2":
            tell(sim, line)
        took_us = []
        for _ in range(10):
            trigger.settle(sim)
            took_us.append(trigger.first_drive_us(sim, "z", sim.time_ps + rng.randrange(50 * US, 150 * US)))
    return max(took_us),


def measure_report():
    """60 triggers at any phase while all axes move and the host asks; and a burst of 20."""
    rng = random.Random(2)
    with power_up() as sim:
        tell(sim, "BU F=3")
        tell(sim, "TTL X=1")
        zero = [round(sim.count(n)) for n in range(4)]
        report.move_all(sim, rng)
        sim.report_read()
        begin = sim.time_ps + 500 * US
        times = [begin + n * 2_500 * US + rng.randrange(400 * US) for n in range(60)]
        pins = report.play(sim, times, lines=b"W X Y Z F\r")
        data, starts = sim.report_read_timed()
        instant_us, skew_us = latched(list(report.binary(data)), times, pins, zero)
        waits_us = [(start - (report.sample_after(time) + report.LATCH) * FAST_PERIOD_PS) / 1e6
                    for start, time in zip(starts[::report.RECORD], times)]
    with power_up() as sim:
        tell(sim, "BU F=3")
        tell(sim, "TTL M=2 X=1")
        begin, gap_ps = sim.time_ps + 100 * US, 210_000
        report.play(sim, [begin + n * gap_ps for n in range(20)], length_ps=gap_ps // 2)
        sim.run(60 * MS)
        if len(sim.report_read()) != 20 * 31:
            raise RuntimeError("records of the burst are missing")
    return max(instant_us), max(instant_us) - min(instant_us), skew_us, max(waits_us), gap_ps / 1e6


def latched(records, times, pins, zero):
    """From each trigger to the sample of the encoder pins that its record shows, us; and the most by which axes differ.

    For each axis, that delay in clocks by which all records show what the pins had then, less where the user's 0 is.
    """
    delays = []
    for axis in range(4):
        fits = []
        for delay in range(-2000, 2001):
            off = {record[axis] - pins.at(report.sample_after(time) + delay)[axis]
                   for record, time in zip(records, times)}
            if len(off) == 1 and abs(off.pop() + zero[axis]) <= 1:
                fits.append(delay)
        if not fits:
            raise RuntimeError(f"the records of axis {axis} fit no instant")
        delays.append(min(fits, key=abs))
    wait = [((report.sample_after(time) + max(delays)) * FAST_PERIOD_PS - time) / 1e6 for time in times]
    return wait, (max(delays) - min(delays)) * FAST_PERIOD_PS / 1e6


def measure_lock():
    """Pulses about as long as the threshold of 0.75 ms, at any phase; and 2000 of 100 kHz while the host asks."""
    rng, long, short = random.Random(3), [], []
    with power_up() as sim:
        for line in "R X=10 Y=0", "RM Y=1", "LR Z=1":
            tell(sim, line)
        sim.run(100 * MS)
        tell(sim, "LK")
        for _ in range(60):
            length_ps = 750 * US + rng.randrange(-12_000, 12_000)
            before = target(sim)
            begin = sim.time_ps + 100 * US + rng.randrange(SYNC_PERIOD_PS)
            sim.schedule_input(begin, "in0", 1)
            sim.schedule_input(begin + length_ps, "in0", 0)
            sim.run(1200 * US)
            (long if target(sim) < before else short).append(length_ps)
        if not long or not short:
            raise RuntimeError("all pulses were judged alike")
        if sum(long) / len(long) < sum(short) / len(short):
            long, short = short, long
        tell(sim, "LK")
        tell(sim, "RT R=0.005")
        tell(sim, "LK")
        begin, count = sim.time_ps + 1 * MS, 2000
        for n in range(count):
            sim.schedule_input(begin + n * 10 * US, "in0", 1)
            sim.schedule_input(begin + n * 10 * US + (3 * US if n % 2 else 7 * US), "in0", 0)
        while sim.time_ps < begin + count * 10 * US:
            if sim.serial_unsent < 16:
                sim.serial_write(b"W X Y Z F\r")
            sim.run(1 * MS)
        sim.run(100 * MS)
        sim.serial_read()
        counted, lost = (int(sim.command(f"LK {letter}?").partition("=")[2]) for letter in "NL")
    return max(0, max(short) - min(long)) / 1e6, 100.0 if counted == count else 0.0, count - counted + lost


def target(sim):
    return float(sim.command("M X?").partition("=")[2])


def measure_light():
    """Periods at the pin: full light, the smallest step, 200 kHz, and exposures at 25 %."""
    with power_up() as sim:
        tell(sim, "TTL Y=9 100")
        sim.run(5 * MS)
        sim.record("out0")
        sim.run(20 * MS)
        full = 100.0 if not len(sim.changes()) and sim.levels()["out0"] else 0.0
        on = [periods(sim, f"LED X={percent}")[-1][2] for percent in (50, 50.0006)]
        tell(sim, "LED R=200000")
        fast = periods(sim, "LED X=50")
        tell(sim, "LED R=1300")
        quarter = periods(sim, "LED X=25")
    length = light.DEFAULT_CLOCKS
    exposed = [light.exposed(quarter, begin_ps, 10 * MS) for begin_ps in range(quarter[2][0], quarter[2][0] + 769 * US, 7 * US)]
    return (full, (on[1] - on[0]) / length * 100, 1e9 / (fast[-1][1] * FAST_PERIOD_PS),
            (max(exposed) - min(exposed)) * FAST_PERIOD_PS / 1e6)


def periods(sim, line):
    """Those of 25 ms that begin with a line, without those of the line before."""
    tell(sim, line)
    sim.run(2 * MS)
    sim.changes()
    sim.run(23 * MS)
    return light.periods(sim.changes())


MEASUREMENTS = {
    "scan": (measure_scan, ("pixel clock: encoder edge to pulse, longest", "pixel clock: jitter, peak to peak",
                            "SYNC: encoder edge to pin, longest", "smallest pixel", "pixel clock of a line in motion",
                            "position in a line, from constant speed, rms")),
    "trigger": (measure_trigger, ("trigger to motor",)),
    "report": (measure_report, ("report: trigger to the instant that is reported, longest", "report: jitter of that instant",
                                "report: first to last axis", "report: last latch to first byte, longest",
                                "report: trigger to trigger, in a burst")),
    "lock": (measure_lock, ("servo lock: undecided lengths of pulses", "servo lock: rate followed",
                            "servo lock: pulses lost of 2000, the host never silent")),
    "light": (measure_light, ("LED: highest brightness", "LED: smallest step of brightness", "LED: highest frequency",
                              "LED: light of exposures of 10 ms at 25 %, most less least")),
}


# --- Judgement and results ---------------------------------------------------------------------------------------------

def originals():
    """``{name: row}`` of ``originals.toml``."""
    return {row["name"]: row for row in tomllib.loads(ORIGINALS.read_text())["row"]}


def judged(original, ours, command):
    """A row of ``timing.json``.  ``ratio``: how many times better ours is, if both are there and above 0.

    ``beats`` is None where nothing is published; where nothing can be less than the original's 0, being as good will do.
    """
    value, less, ours = original.get("value"), original["better"] == "less", float(ours)
    ratio = beats = None
    if value is not None:
        beats = ours < value if less else ours > value
        beats |= less and value == ours == 0
        if value and ours:
            ratio = round(value / ours if less else ours / value, 3)
    return {"name": original["name"], "unit": original["unit"], "original": value, "ours": round(ours, 9), "ratio": ratio,
            "beats": beats, "command": command, "source": original["source"]}


def measure(groups, show=print):
    """Rows of the groups, in the order of ``originals.toml``."""
    rows, of = {}, originals()
    for group in groups:
        function, names = MEASUREMENTS[group]
        for name, ours in zip(names, function(), strict=True):
            rows[name] = row = judged(of[name], ours, f"make bench-timing ARGS={group}")
            verdict = {True: "", False: "  WORSE", None: "  nothing published"}[row["beats"]]
            theirs = "–" if row["original"] is None else f"{row['original']:g}"
            ratio = f"{row['ratio']:.4g}" if row["ratio"] else "–"
            show(f"{name:64} {ours:12.6g} {theirs:>8} {row['unit']:7}{ratio:>8}{verdict}", flush=True)
    return [rows[name] for name in of if name in rows]


def plot(rows):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    rows = [row for row in rows if row["ratio"]][::-1]
    figure, axis = pyplot.subplots(figsize=(9, 0.35 * len(rows) + 1.2))
    axis.barh([row["name"] for row in rows], [row["ratio"] for row in rows], color="#246")
    axis.set_xscale("log")
    axis.axvline(1, color="#a00")
    axis.set_xlabel("times better than the original")
    figure.tight_layout()
    figure.savefig(DIRECTORY / "timing.png")
    pyplot.close(figure)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="make bench-timing", description=__doc__.split("\n\n")[0])
    parser.add_argument("group", nargs="*", help=f"of {', '.join(MEASUREMENTS)}; all of them without")
    groups = parser.parse_args(arguments).group or list(MEASUREMENTS)
    if unknown := [group for group in groups if group not in MEASUREMENTS]:
        parser.error(f"there is no {', '.join(unknown)}; there are {', '.join(MEASUREMENTS)}")
    DIRECTORY.mkdir(parents=True, exist_ok=True)
    print(f"{'':64} {'ours':>12} {'original':>8} {'unit':7}{'ratio':>8}")
    rows = measure(groups)
    (DIRECTORY / "timing.json").write_text(json.dumps({"rows": rows}, indent=1) + "\n")
    plot(rows)
    print(f"{DIRECTORY / 'timing.json'}, {DIRECTORY / 'timing.png'}")
    return 1 if any(row["beats"] is False for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
