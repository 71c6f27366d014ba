# SPDX-License-Identifier: BSD-2-Clause
"""The demonstration: one scan line, commanded over the serial pins and measured at the pins.

``python -m tb.demo`` (or ``make demo``) powers up the simulated controller on its board and sends what a host
would send. Nothing inside the controller is looked at: the verdict comes from ``pins.vcd`` alone, read back by
the same analyser that measures a real board. One file per idea:

scenario   what is asked for, the commands that ask for it, and what must come out (computed on its own)
console    the host's end of the serial line
recorder   pins to ``pins.vcd``, the stage's true motion to memory
session    power-up, set-up, line, end
verdict    the figures, the report, and whether the line is exact
"""
