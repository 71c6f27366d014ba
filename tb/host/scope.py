# SPDX-License-Identifier: BSD-2-Clause
"""An independent model of a scan line as an oscilloscope would see it, to test the analyser with.

It walks the encoder edges one at a time and keeps the state the gateware keeps (position, furthest
progress, and the amount due for the next pixel), where the analyser works on whole arrays with a closed
formula. Edges are sampled by an ideal clock; outputs change a constant number of clocks later.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from fractions import Fraction

CLOCK_PS = 5000
CYCLE = [(0, 0), (1, 0), (1, 1), (0, 1)]                     # A, B as the count rises


def travel(counts: int, mean_ps: int, seed: int, start_ps: int = 100_000) -> list[tuple[int, int]]:
    """(time, step) of edges ``counts`` far (signed), each interval within 30 % of ``mean_ps``."""
    random_ = random.Random(seed)
    step, edges, time_ps = (1 if counts > 0 else -1), [], start_ps
    for _ in range(abs(counts)):
        time_ps += random_.randint(mean_ps * 7 // 10, mean_ps * 13 // 10)
        edges.append((time_ps, step))
    return edges


def then(edges: list[tuple[int, int]], steps: list[int], interval_ps: int) -> list[tuple[int, int]]:
    """``edges`` followed by single steps at even intervals."""
    time_ps = edges[-1][0]
    return edges + [(time_ps + (i + 1) * interval_ps, step) for i, step in enumerate(steps)]


def onward(edges, more):
    """``edges`` followed by ``more``, whose times are moved to come after."""
    shift = edges[-1][0] - more[0][0] + 20_000_000
    return edges + [(time_ps + shift, step) for time_ps, step in more]


@dataclass
class Scope:
    """Pins of one axis over one or several lines.

    Members
    -------
    edges : list of (time_ps, step)
    n : Fraction or int
        Counts per pixel; its binary fraction has 32 bits.
    pixels : int
        Pixels per line.
    lines : list of (reference edge, direction[, phase])
        Edge e is the boundary between counts e-1 and e. The phase is a fraction of a count below 1 (default: the
        largest of 32 bits).
    pulses, sync : lists of [rise_ps, fall_ps]
        The outputs, filled by :meth:`run`; tests then change them.
    """

    edges: list[tuple[int, int]]
    n: Fraction | int
    pixels: int
    lines: list[tuple]
    latency_clocks: int = 10
    clock_phase_ps: int = 1234
    width_ps: int = 50_000
    pulses: list[list[int]] = field(default_factory=list)
    sync: list[list[int]] = field(default_factory=list)

    def run(self) -> Scope:
        """Walk the edges and make SYNC and the pulses; return self."""
        position, waiting = 0, list(self.lines)
        scale = 1 << 32
        n_scaled = int(Fraction(self.n) * scale)
        state = None
        for time_ps, step in self.edges:
            position += step
            if state is None:
                if waiting:
                    edge, direction, *phase = waiting[0]
                    if step == direction and position == (edge if direction > 0 else edge - 1):
                        waiting.pop(0)
                        self.sync.append([self._out_ps(time_ps), None])
                        state = {"direction": direction, "progress": 0, "furthest": 0, "made": 0,
                                 "due": n_scaled + (int(phase[0] * scale) if phase else scale - 1)}
                continue
            state["progress"] += step * state["direction"]
            if state["progress"] <= state["furthest"]:
                continue
            state["furthest"] += 1
            if state["due"] < (state["furthest"] + 1) * scale:
                state["due"] += n_scaled
                state["made"] += 1
                out_ps = self._out_ps(time_ps)
                self.pulses.append([out_ps, out_ps + self.width_ps])
                if state["made"] == self.pixels:
                    self.sync[-1][1] = out_ps
                    state = None
        return self

    def _out_ps(self, edge_ps: int) -> int:
        sampled = -(-(edge_ps - self.clock_phase_ps) // CLOCK_PS) * CLOCK_PS + self.clock_phase_ps
        return sampled + self.latency_clocks * CLOCK_PS

    def changes(self) -> list[tuple[int, str, int]]:
        """Every pin change in time order, (time, name, level); all pins start low."""
        events, place = [], 0
        for time_ps, step in self.edges:
            before = CYCLE[place & 3]
            place += step
            now = CYCLE[place & 3]
            name = "x_a" if before[0] != now[0] else "x_b"
            events.append((time_ps, name, now[0] if name == "x_a" else now[1]))
        for name, pulses in (("encoder", self.pulses), ("sync", self.sync)):
            for rise_ps, fall_ps in pulses:
                events.append((rise_ps, name, 1))
                if fall_ps is not None:
                    events.append((fall_ps, name, 0))
        return sorted(events)

    def write_vcd(self, path, names=("x_a", "x_b", "sync", "encoder"), end_ps=None):
        """A dump at 1 ps, with a vector and an idle signal as bystanders."""
        codes = dict(zip(("x_a", "x_b", "sync", "encoder"), "!\"#%"))
        rows = ["$date today $end", "$timescale", "  1 ps", "$end", "$scope module top $end"]
        rows += [f"$var wire 1 {code} {name} $end" for name, code in zip(names, codes.values())]
        rows += ["$var wire 4 & limits [3:0] $end", "$upscope $end", "$enddefinitions $end", "#0", "$dumpvars"]
        rows += [f"0{code}" for code in codes.values()] + ["b0000 &", "$end"]
        time = 0
        for time_ps, name, level in self.changes():
            if end_ps is not None and time_ps > end_ps:
                break
            if time_ps != time:
                rows.append(f"#{time_ps}")
                time = time_ps
            rows.append(f"{level}{codes[name]}")
        rows.append(f"#{end_ps or time + 1_000_000}")
        path.write_text("\n".join(rows) + "\n")
        return path

    def write_change_csv(self, path):
        """A row per change, time in seconds, as one maker's software exports."""
        level = {"x_a": 0, "x_b": 0, "sync": 0, "encoder": 0}
        rows = ["Time [s]," + ",".join(level), "0.000000000000,0,0,0,0"]
        for time_ps, name, now in self.changes():
            level[name] = now
            rows.append(f"{time_ps / 1e12:.12f}," + ",".join(map(str, level.values())))
        path.write_text("\n".join(rows) + "\n")
        return path

    def write_sampled_csv(self, path, period_ps):
        """A row per sample without a time column, as another's exports."""
        level = {"x_a": 0, "x_b": 0, "sync": 0, "encoder": 0}
        rows = ["; Channels (4/4): x_a, x_b, sync, encoder", f"; Samplerate: {10**6 / period_ps:g} MHz",
                "logic,logic,logic,logic"]
        time_ps = 0
        for change_ps, name, now in self.changes():
            while time_ps < change_ps:
                rows.append(",".join(map(str, level.values())))
                time_ps += period_ps
            level[name] = now
        rows.append(",".join(map(str, level.values())))
        path.write_text("\n".join(rows) + "\n")
        return path
