# SPDX-License-Identifier: BSD-2-Clause
"""Recorded pin changes to a VCD file, timescale 1 ps.

A writer of a few lines instead of a library: a scan line has 10^5 changes, and its times need no reordering.
"""

from tb.sim.simulator import SCAN_SIGNALS, SIGNALS


class VcdWriter:
    """Write changes as they come.

    Parameters
    ----------
    file : text file
        Open for writing; stays open.
    time_ps : int
        When the record begins.
    levels : dict
        ``{signal: level}`` at that time, for at least ``signals``.
    signals : sequence of str
        What to write, in the order of the file.
    """

    def __init__(self, file, *, time_ps, levels, signals=SCAN_SIGNALS):
        self._file = file
        self._ids = {SIGNALS.index(signal): chr(33 + n) for n, signal in enumerate(signals)}
        self._time_ps = time_ps
        file.write("$timescale 1 ps $end\n$scope module pins $end\n")
        for index, name in self._ids.items():
            file.write(f"$var wire 1 {name} {SIGNALS[index]} $end\n")
        file.write(f"$upscope $end\n$enddefinitions $end\n#{time_ps}\n$dumpvars\n")
        for index, name in self._ids.items():
            file.write(f"{levels[SIGNALS[index]]}{name}\n")
        file.write("$end\n")

    def write(self, changes):
        """Append an array of changes as :meth:`Simulator.changes` gives it; other signals are left out."""
        lines = []
        for time_ps, signal, level in changes.tolist():
            if (name := self._ids.get(signal)) is None:
                continue
            if time_ps != self._time_ps:
                lines.append(f"#{time_ps}\n")
                self._time_ps = time_ps
            lines.append(f"{level}{name}\n")
        self._file.write("".join(lines))

    def finish(self, time_ps):
        """Mark the end of the record."""
        if time_ps != self._time_ps:
            self._file.write(f"#{time_ps}\n")
            self._time_ps = time_ps
