# SPDX-License-Identifier: BSD-2-Clause
"""What a scan line must do, from the definition: encoder edges in, SYNC and pixel edges out.

Exact (Python integers and fractions), and written from the meaning of the words rather than from the gateware:
pixel k belongs to the edge that brings progress to floor(k * N + phi), where progress is how far the stage has
come beyond the reference edge.  No counter, no recurrence.
"""

import dataclasses
from fractions import Fraction
from math import floor

__all__ = ["Expected", "Line", "Step", "expect", "pulses"]


@dataclasses.dataclass(frozen=True)
class Step:
    """An encoder edge: at ``time`` (any unit), ``axis`` moved by ``direction``, +1 or -1."""
    time: int
    axis: int
    direction: int


@dataclasses.dataclass(frozen=True)
class Line:
    """Settings of a line, in the numbers of its registers."""
    reference: int
    reverse: bool = False
    whole: int = 1
    fraction: int = 0
    phase: int = 0xffffffff
    pixels: int = 1
    axis: int = 0
    pixel_axis: int = 0

    @property
    def direction(self):
        return -1 if self.reverse else 1

    def pixel_progress(self, k):
        """Edges beyond the reference at which pixel k = 1... comes."""
        return floor(k * (self.whole + Fraction(self.fraction, 2**32)) + Fraction(self.phase, 2**32))

    def edge_crossed(self, step, count):
        """Edge that a step crossed which left ``count``: the boundary between its two counts."""
        return count if step.direction > 0 else count + 1


@dataclasses.dataclass
class Expected:
    """Times are those of the steps that cause the change; ``None``: does not happen."""
    late: bool = False
    rise: int | None = None                 # SYNC on
    fall: int | None = None                 # SYNC off
    pixels: list = dataclasses.field(default_factory=list)
    end_position: int = 0                   # counts, at the last pixel; 0 if there was none


def expect(line, steps, *, start, armed, ended=None):
    """The line that ``steps`` make.

    ``start``: {axis: count before the first step}.  ``armed``: time at which arming samples the stage; steps up
    to and including it are past.  ``ended``: time from which a disarming has effect.
    """
    result = Expected()
    position = dict(start)
    reach = 0
    judged = False

    def judge():
        # Up to 2**31 - 1 counts ahead is ahead.
        before = line.reference - 1 if line.direction > 0 else line.reference
        ahead = (before - position[line.axis]) * line.direction
        result.late = ahead % 2**32 >= 2**31 - line.reverse

    for step in sorted(steps, key=lambda s: (s.time, s.axis)):
        if not judged and step.time > armed:
            judge()
            judged = True
        if ended is not None and step.time >= ended:
            break
        position[step.axis] += step.direction
        if not judged or result.late:
            continue
        if result.rise is None:
            if (step.axis == line.axis and step.direction == line.direction
                    and (line.edge_crossed(step, position[step.axis]) - line.reference) % 2**32 == 0):
                result.rise = step.time
                here = position[line.pixel_axis]
                # A pixel-axis step at the very same time is part of where the line begins.
                here += sum(s.direction for s in steps
                            if s.time == step.time and s.axis == line.pixel_axis != line.axis
                            and s.axis > step.axis)
        elif step.axis == line.pixel_axis and result.fall is None and step.time > result.rise:
            progress = (position[step.axis] - here) * line.direction
            if progress > reach:
                reach = progress
                if progress == line.pixel_progress(len(result.pixels) + 1):
                    result.pixels.append(step.time)
                    result.end_position = position[step.axis]
                    if len(result.pixels) == line.pixels:
                        result.fall = step.time
    if not judged:
        judge()
    if result.rise is not None and result.fall is None and ended is not None:
        result.fall = ended
    return result


def pulses(triggers, width):
    """``([(rise, fall)], merged)`` of pulses of ``width`` for triggers at the given times, each one clock later."""
    levels, merged = [], 0
    for time in triggers:
        if levels and time < levels[-1][1]:
            merged += 1
            levels[-1] = (levels[-1][0], time + 1 + width)
        else:
            levels.append((time + 1, time + 1 + width))
    return levels, merged
