# SPDX-License-Identifier: BSD-2-Clause
"""From ``pins.vcd`` to the reports, the picture, and whether the line is exact."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from host.jitter import Capture, Divide, Figures, Settings, measure
from host.jitter.plot import draw
from host.jitter.report import as_dict, as_text
from host.jitter.vcd import read_vcd

from .scenario import Scenario
from .session import Outcome

# docs/timing.md: from the fast clock that samples an encoder edge to the pin.  A number of its own, not the gateware's
# constants: it is what the pins are held to, and the filters are off.
LATENCY_CLOCKS = 10
LATENCY_WINDOW_PS = (0, 500_000)
STANDSTILL_PS = 100_000_000_000                              # no edge for so long: the stage stands


def judge(scenario: Scenario, outcome: Outcome, directory: Path) -> tuple[dict, str]:
    """Measure ``pins.vcd`` in ``directory``, write report and picture beside it.

    Returns the report, and its text without the transcript. The report's ``failures`` are empty when the line is exact.
    """
    a, b = f"{scenario.axis}_a", f"{scenario.axis}_b"
    channels = (a, b, "sync", "encoder")
    capture = read_vcd(directory / "pins.vcd", list(channels))
    figures = measure(capture, *channels, Settings(
        divide=Divide.from_decimal(scenario.n), pixels=None if scenario.cut_pwm else scenario.pixels(),
        latency_ps=LATENCY_WINDOW_PS, counts_per_mm=float(scenario.counts_per_mm())))
    deviation = deviation_counts(scenario, outcome, figures)
    report = as_dict(figures) | {
        "scenario": scenario.title(),
        "pixels_computed": scenario.pixels(),
        "left_over_counts": float(scenario.left_over_counts()),
        "following_error_counts": None if deviation is None else {
            "max": round(float(np.abs(deviation[1]).max()), 4),
            "rms": round(float(np.sqrt(np.mean(deviation[1] ** 2))), 4)},
        "simulated_s": round(outcome.simulated_s, 6),
        "wall_s": round(outcome.wall_s, 3),
        "times_slower_than_real": round(outcome.wall_s / outcome.simulated_s, 2) if outcome.simulated_s else None,
        "cpu_awake_share": round(outcome.awake_share, 4),
        "flood_replies": outcome.flood_replies,
        "transcript": outcome.transcript,
    }
    if scenario.cut_pwm:
        report["stop"] = stop(scenario, outcome, capture, figures)
    report["failures"] = outcome.failures + failures(scenario, report)
    (directory / "report.json").write_text(json.dumps(report, indent=2) + "\n")
    (directory / "report.txt").write_text(text(scenario, figures, report, report["transcript"]))
    draw(figures, capture, channels, directory / "scan.png", f"Abbe: {scenario.title()}", float(scenario.speed),
         deviation)
    return report, text(scenario, figures, report)


def failures(scenario: Scenario, report: dict) -> list[str]:
    """Everything by which the pulse train is not the exact one, from the report's figures alone."""
    wrong = []

    def must(name, got, expected):
        if got != expected:
            wrong.append(f"{name}: {got}, expected {expected}")

    for name in ("missed", "extra", "moved", "merged", "short", "illegal_edges"):
        must(name, report[name], 0)
    must("SYNC edges", report["sync_edges"], 1)
    must("start, counts", report["start_counts"], scenario.start_counts())
    if scenario.cut_pwm:
        if not report["stop"]["standing"]:
            wrong.append("the stage did not stop when the PWM wire was cut")
        return wrong
    must("pixels", report["pixels"], scenario.pixels())
    if not report["latency_ns"]:
        return wrong + ["no pulse to measure"]
    must("latency, clocks", report["latency_clocks"], LATENCY_CLOCKS)
    if report["clock_phase_ns"] is None:
        wrong.append("SYNC and pixel pulses do not leave at one phase of the clock")
    if not report["jitter_ns"]["pp"] < report["jitter_limit_ns"]:
        wrong.append(f"jitter: {report['jitter_ns']['pp']} ns, expected less than {report['jitter_limit_ns']}")
    if not report["phase_bins_spread"]:
        wrong.append(f"edge phases are not spread over the clock, so jitter is not fully seen: {report['phase_bins']}")
    # Whatever else the analyser had to say is a failure too.
    return wrong or report["findings"]


def deviation_counts(scenario: Scenario, outcome: Outcome, figures: Figures):
    """True position less the straight line at exactly the commanded speed, over the active line.

    Where that line lies in time is free (least squares): pixels are tied to the position, so a constant lag
    of the stage behind its set-point moves nothing. Returns times in ps and counts, or None without a line.
    """
    lines = [line for line in figures.lines if line.reference_ps is not None]
    if not lines or outcome.motion is None:
        return None
    times, position, _ = outcome.motion
    end_ps = outcome.cut_ps or lines[0].end_ps
    inside = (times >= lines[0].reference_ps) & (times <= end_ps)
    if inside.sum() < 2:
        return None
    times, position = times[inside], position[inside]
    counts_per_ps = float(scenario.speed) * float(scenario.counts_per_mm()) * lines[0].direction / 1e12
    error = position - counts_per_ps * (times - times[0])
    return times, error - error.mean()


def stop(scenario: Scenario, outcome: Outcome, capture: Capture, figures: Figures) -> dict:
    """How the stage stopped after its PWM wire was cut."""
    if outcome.cut_ps is None:
        return {"standing": False}
    edges = figures.count.times_ps
    last_ps = int(edges[-1]) if len(edges) else 0
    distance = abs(figures.count.at(capture.end_ps) - figures.count.at(outcome.cut_ps))
    return {
        "standing": bool(capture.end_ps - last_ps >= STANDSTILL_PS and outcome.motion[2][-1] == 0),
        "after_ms": round(max(0, last_ps - outcome.cut_ps) / 1e9, 3),
        "distance_counts": int(distance),
    }


def text(scenario: Scenario, figures: Figures, report: dict, transcript=None) -> str:
    """The report for a person: with a transcript it is for a file, without one it follows what was shown."""
    more = []
    if report["following_error_counts"]:
        error = report["following_error_counts"]
        # No ratio: ours is that of a model, the original's of a real stage.
        more += [("following error, rms", f"{error['rms']:.3f} counts", None),
                 ("following error, max", f"{error['max']:.3f} counts", None)]
    more.append(("left over at the end", f"{report['left_over_counts']:g} counts", None))
    verdict = "The line is exact." if not report["failures"] else "The line is NOT exact:"
    if scenario.cut_pwm and not report["failures"]:
        verdict = (f"The stage stopped {report['stop']['after_ms']:g} ms and {report['stop']['distance_counts']} "
                   "counts after its PWM wire was cut; every pulse until then is exact.")
    return "\n".join([
        *([f"Abbe: {scenario.title()}", ""] if transcript else []),
        verdict, *(f"  {failure}" for failure in report["failures"]), "",
        *([*transcript, ""] if transcript else []),
        as_text(figures, more).rstrip(), "",
        "following error: true position less a straight line at exactly the commanded speed; latency: encoder edge",
        "to the pin; jitter: latency's spread, which is the sampling clock's period and nothing else.", "",
        f"simulated {report['simulated_s']:.3f} s in {report['wall_s']:.1f} s: "
        f"{report['times_slower_than_real']:.0f} times slower than real time, "
        f"CPU awake {100 * report['cpu_awake_share']:.0f} % of the clocks",
    ]) + "\n"
