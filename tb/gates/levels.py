# SPDX-License-Identifier: BSD-2-Clause
"""Which tests of blocks run on the netlist in the ordinary suite.  ``make test-gates`` runs all of them."""

__all__ = ["ORDINARY"]

ORDINARY = {
    "tb/rtl/test_line.py::test_pin_to_pin[gates]",          # decoder, compare, divider, pulse, router: pin to pin
    "tb/rtl/test_snapshot.py::test_snapshot[gates]",        # crossings both ways, 64-bit time
    "tb/rtl/test_pwm.py::test_pwm[gates-60]",               # the pins that drive motors
    "tb/rtl/test_inputs.py::test_interlock[gates]",         # what takes the drive off
}
"""A block of each kind; most of the time goes into compiling the netlists."""
