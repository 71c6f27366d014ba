# SPDX-License-Identifier: BSD-2-Clause
"""Measure a scan line from its pins: A, B, SYNC and the pixel clock, and nothing else.

``python -m host.jitter FILE`` reads a value change dump or a logic analyser's CSV, rebuilds the count
from A and B, takes the reference from SYNC and the divide from N, and pairs every pixel pulse with the
one encoder edge that should have caused it. One file per idea:

capture     named channels as toggle times, whatever file they came from
vcd, table  the two kinds of file
count       A and B to a count, one step per edge
divide      N with its 32-bit fraction: which edge completes pixel k
pairing     SYNC pulses to lines, pulses to pixels k
statistics  what the lines amount to: latency, jitter, phases, and what is wrong
report      the figures as JSON, and as text beside the original's
plot        the picture
"""

from .capture import Capture, CaptureError, Trace
from .divide import Divide
from .statistics import Figures, Settings, measure

__all__ = ["Capture", "CaptureError", "Trace", "Divide", "Figures", "Settings", "measure"]
