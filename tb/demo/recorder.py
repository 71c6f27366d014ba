# SPDX-License-Identifier: BSD-2-Clause
"""Pins to ``pins.vcd`` as they change; the stage's true motion to memory."""

from __future__ import annotations

import numpy as np

from tb.sim.simulator import SCAN_SIGNALS, SIGNALS
from tb.sim.vcd import VcdWriter

SAMPLE_PS = 20_000_000
SYNC, ENCODER = SIGNALS.index("sync"), SIGNALS.index("encoder")


class Recorder:
    """Record from now on.

    Members
    -------
    sync : int
        Level of SYNC now.
    sync_edges, pulses : int
        Rising edges so far, for the progress bar; the verdict counts for itself.
    """

    def __init__(self, sim, file):
        self._sim = sim
        levels = sim.levels()
        self._vcd = VcdWriter(file, time_ps=sim.time_ps, levels=levels)
        self._samples = []
        self.sync, self.sync_edges, self.pulses = levels["sync"], 0, 0
        sim.record(*SCAN_SIGNALS)
        sim.sample(SAMPLE_PS)

    def take(self):
        """Move what was recorded since the last call to its place."""
        changes = self._sim.changes()
        self._vcd.write(changes)
        self._samples.append(self._sim.samples())
        sync = changes["level"][changes["signal"] == SYNC]
        if len(sync):
            self.sync = int(sync[-1])
            self.sync_edges += int(sync.sum())
        self.pulses += int(changes["level"][changes["signal"] == ENCODER].sum())

    def finish(self):
        """Mark the end of the dump."""
        self.take()
        self._vcd.finish(self._sim.time_ps)

    def motion(self, axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Times in ps, true positions in counts and true speeds in counts/s of an axis."""
        samples = np.concatenate(self._samples)
        return samples["time_ps"], samples["position_counts"][:, axis], samples["speed_counts_per_s"][:, axis]
