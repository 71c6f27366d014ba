# SPDX-License-Identifier: BSD-2-Clause
"""Power-up, set-up, line, end: the demonstration from the host's chair."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from tqdm import tqdm

from .console import MS, S, Console, Flood, ReplyError, ScanRefused
from .recorder import Recorder
from .scenario import AXES, Scenario

STEP_PS = 2 * MS
POLL_PS = 10 * MS
REST_PS = 20 * MS                                            # recorded after the scan, the stage at rest
CUT_PS = 200 * MS                                            # recorded after the wire is cut


@dataclass
class Outcome:
    """What a session leaves beside ``pins.vcd``.

    Members
    -------
    motion : (times_ps, position_counts, speed_counts_per_s)
        True motion of the fast axis.
    failures : list of str
        What the host found wrong: replies, time-outs.
    transcript : list of str
        Commands and replies.
    cut_ps : int or None
        When the PWM wire was cut.
    """

    simulated_s: float = 0.0
    wall_s: float = 0.0
    awake_share: float = 0.0
    motion: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
    failures: list[str] = field(default_factory=list)
    transcript: list[str] = field(default_factory=list)
    flood_replies: int | None = None
    cut_ps: int | None = None


class Session:
    """Run a scenario on a simulator just powered up, writing ``vcd_path``."""

    def __init__(self, sim, scenario: Scenario, vcd_path: Path):
        self._sim, self._scenario, self._path = sim, scenario, vcd_path
        self._outcome = Outcome()
        self._flood = None

    def run(self) -> Outcome:
        """Do it all; what goes wrong is in the outcome, and the record up to there is kept."""
        started = time.monotonic()
        estimate_ms = 1000 * (self._scenario.approach_s() + self._scenario.line_s() + 0.3)
        with open(self._path, "w", encoding="ascii") as file, \
                tqdm(total=round(estimate_ms), unit="ms", desc="power-up", mininterval=0.3, dynamic_ncols=True,
                     bar_format="{desc:<8} |{bar}| {n:.0f}/{total:.0f} ms simulated [{elapsed}<{remaining}]{postfix}",
                     disable=None) as self._bar:
            self._started, self._recorder = started, Recorder(self._sim, file)
            self._console = Console(self._sim, self._advance, self._say)
            try:
                self._scan()
            except ReplyError as error:
                self._outcome.failures.append(str(error))
            else:
                self._bar.total = self._bar.n = round(self._sim.time_ps / MS)
                self._bar.set_description_str("done")
            self._recorder.finish()
        clocks, awake = self._sim.clocks
        outcome = self._outcome
        outcome.simulated_s = self._sim.time_ps / S
        outcome.wall_s = time.monotonic() - started
        outcome.awake_share = awake / clocks if clocks else 0.0
        outcome.motion = self._recorder.motion(AXES[self._scenario.axis])
        return outcome

    def _scan(self):
        self._console.wait_until_up()
        self._bar.set_description_str("set-up")
        for command in self._scenario.commands():
            self._order(command)
        self._bar.set_description_str("run-up")
        self._until(lambda: self._recorder.sync, self._scenario.approach_s() * 4 + 1, "SYNC did not come")
        self._bar.set_description_str("line")
        self._bar.total = round(self._sim.time_ps / MS + 1000 * (self._scenario.line_s() + 0.3))
        if self._scenario.cut_pwm:
            self._cut()
            return
        if self._scenario.flood:
            self._flood = Flood(self._sim, self._console)
        self._until(lambda: not self._recorder.sync, self._scenario.line_s() * 1.5 + 0.5, "SYNC did not end")
        if self._flood:
            self._end_flood()
        self._bar.set_description_str("return")
        self._until_idle()
        self._advance(REST_PS)

    def _order(self, command):
        """A line that the controller refuses, out of range, is the end of it; any other refusal is a finding."""
        try:
            self._console.order(command)
        except ReplyError as error:
            if command.startswith("SCAN") and ":N-4" in str(error):
                raise ScanRefused(f"{error}: the controller cannot scan this line (N too small for the speed and "
                                  "the pulse width, or no room to run up)") from None
            raise

    def _until_idle(self):
        """A host's wait: ask until the answer is N."""
        end_ps = self._sim.time_ps + 3 * S
        while self._console.busy():
            if self._sim.time_ps > end_ps:
                raise ReplyError("still busy 3 s after the line")
            self._advance(POLL_PS)
        self._say(f"{self._sim.time_ps / S:8.3f} s  > {'/':<28} < N")

    def _cut(self):
        half = self._scenario.pixels() // 2
        self._until(lambda: self._recorder.pulses >= half, self._scenario.line_s() * 1.5 + 0.5,
                    f"pixel {half} did not come")
        self._sim.cut_pwm([AXES[self._scenario.axis]])
        self._outcome.cut_ps = self._sim.time_ps
        self._say(f"{self._sim.time_ps / S:8.3f} s  the PWM wire of {self._scenario.axis.upper()} is cut")
        self._advance(CUT_PS)

    def _end_flood(self):
        flood, self._flood = self._flood, None
        end_ps = self._sim.time_ps + 200 * MS
        while not flood.done() and self._sim.time_ps < end_ps:
            self._advance(STEP_PS)
            flood.step(more=False)
        self._outcome.flood_replies = flood.answered
        self._say(f"{self._sim.time_ps / S:8.3f} s  {flood.sent} times W X Y during the line, "
                  f"{flood.answered} answered")
        if flood.answered != flood.sent:
            self._outcome.failures.append(f"{flood.sent} flooding commands, {flood.answered} replies")
        self._outcome.failures += [f"'W X Y' was answered {line!r}" for line in flood.wrong[:10]]

    def _until(self, condition, timeout_s, complaint):
        end_ps = self._sim.time_ps + int(timeout_s * S)
        while not condition():
            if self._sim.time_ps > end_ps:
                raise ReplyError(f"{complaint} within {timeout_s:.1f} s")
            self._advance(STEP_PS)

    def _advance(self, duration_ps):
        """Let time pass in steps, keeping records, flood and progress going."""
        end_ps = self._sim.time_ps + duration_ps
        while (left_ps := end_ps - self._sim.time_ps) > 0:
            self._sim.run(min(left_ps, STEP_PS))
            self._recorder.take()
            if self._flood:
                self._flood.step()
        now_ms = self._sim.time_ps / MS
        wall_s = max(time.monotonic() - self._started, 1e-3)
        slower = wall_s * 1000 / max(now_ms, 1e-3)
        self._bar.total = max(self._bar.total, round(now_ms))
        self._bar.n = now_ms
        self._bar.set_postfix_str(f"pixel {self._recorder.pulses}/{self._scenario.pixels()}, "
                                  f"{slower:.0f} times slower than real time", refresh=False)
        self._bar.update(0)

    def _say(self, line):
        self._outcome.transcript.append(line)
        self._bar.write(line)
