# SPDX-License-Identifier: BSD-2-Clause
"""``make bench``: the servo on four lead screws, beside the original's figures, with other motors and frictions.

Runs ``tb/bench/motion.c`` (the firmware on the host, its loop closed over the board model), prints a table, and
writes ``build/bench/motion.json`` and ``build/bench/motion.png``.  Ends with 1 when a figure misses its bound.
"""

import json
import subprocess
import sys
from dataclasses import dataclass

from tb import toolchain

DIRECTORY = toolchain.BUILD / "bench"
RAMP_MS = 16
"""ACCEL of all moves."""

NEARNESS = "strong", "drive", "speed", "following"
"""How near the interlock has come to a false fault, in parts of its limits."""

RMS_COUNTS = 2.0
"""Bound of the following error at constant speed."""


@dataclass(frozen=True)
class Screw:
    """A screw, and what the original's manual (Advanced Applications, array module) gives for it."""
    name: str
    pitch_mm: float
    resolution_counts: float
    original_ms: tuple   # 9 mm, 0.2 mm
    bound_ms: tuple


SCREWS = (
    Screw("A", 1.5875, 14.5, (6700, 235), (5360, 150)),
    Screw("B", 6.35, 11.3, (1670, 70), (1400, 55)),
    Screw("C", 12.7, 11.3, (820, 49), (730, 40)),
    Screw("D", 25.4, 11.3, (480, 40), (400, 32)),
)

TIME, FRICTION = "x.mechanical_time_constant_ms", ("x.running_friction", "x.breakaway_friction")
PLANTS = {
    "as specified": [],
    "time constant -30 %": [f"{TIME}*=0.7"], "time constant +30 %": [f"{TIME}*=1.3"],
    "friction -30 %": [f"{name}*=0.7" for name in FRICTION], "friction +30 %": [f"{name}*=1.3" for name in FRICTION],
}


def measure(screw, changes, *options):
    """``{figure: value}`` of one trial."""
    command = [toolchain.BUILD / "host" / "motion", str(screw.pitch_mm), *changes, f"/AC X={RAMP_MS}", *options]
    run = subprocess.run(command, capture_output=True, text=True, timeout=600)
    if run.returncode:
        sys.exit(f"{screw.name}: {run.stderr or run.stdout}")
    return {name: float(value) for name, value in (pair.split("=") for pair in run.stdout.split())}


def misses(screw, figures):
    """The figures that are not within their bounds."""
    bounds = {"far_ms": screw.bound_ms[0], "near_ms": screw.bound_ms[1], "fast_rms": RMS_COUNTS,
              "slow_rms": RMS_COUNTS, "far_error": screw.resolution_counts + 1,
              "near_error": screw.resolution_counts + 1}
    missed = [name for name, bound in bounds.items() if not figures[name] <= bound]
    return missed + ["interlock"] * (figures["faults"] != 0)


def plot(traces):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(len(traces), 1, figsize=(8, 8), sharex=True)
    for axis, (name, rows) in zip(axes, traces.items()):
        times, setpoint, position = zip(*rows)
        axis.plot(times, setpoint, label="set-point")
        axis.plot(times, position, label="stage")
        axis.set_ylabel(f"screw {name}\ncounts")
    axes[0].legend()
    axes[-1].set_xlabel("ms after the reply to the command")
    figure.suptitle("0.2 mm moves")
    figure.tight_layout()
    figure.savefig(DIRECTORY / "motion.png")


def main():
    DIRECTORY.mkdir(parents=True, exist_ok=True)
    toolchain.run(["make", "--no-print-directory", "-C", "firmware", "bench"], cwd=toolchain.ROOT)
    print("        9 mm                     0.2 mm                  following, counts rms   nearest to\n"
          "screw   ms      original  ratio  ms     original  ratio  fast   slow    a fault")
    results, traces, bad = [], {}, []
    for screw in SCREWS:
        for plant, changes in PLANTS.items():
            trace = DIRECTORY / f"{screw.name}.txt"
            figures = measure(screw, changes, *([] if changes else [f"@{trace}"]))
            if not changes:
                traces[screw.name] = [tuple(map(float, line.split())) for line in trace.read_text().splitlines()]
            missed = misses(screw, figures)
            bad += missed
            results.append({"screw": screw.name, "plant": plant, **figures, "original_far_ms": screw.original_ms[0],
                            "original_near_ms": screw.original_ms[1], "bound_far_ms": screw.bound_ms[0],
                            "bound_near_ms": screw.bound_ms[1], "missed": missed})
            far, near = screw.original_ms
            print(f"{screw.name}     {figures['far_ms']:7.1f} {far:7}     {figures['far_ms'] / far:5.2f} "
                  f"{figures['near_ms']:6.1f} {near:7}    {figures['near_ms'] / near:5.2f}   {figures['fast_rms']:5.2f}"
                  f"  {figures['slow_rms']:5.2f}   {max(figures[n] for n in NEARNESS):5.2f}   {plant}"
                  f"{'  MISSED: ' + ', '.join(missed) if missed else ''}",
                  flush=True)
    (DIRECTORY / "motion.json").write_text(json.dumps(results, indent=1) + "\n")
    plot(traces)
    print(f"{DIRECTORY / 'motion.json'}, {DIRECTORY / 'motion.png'}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
