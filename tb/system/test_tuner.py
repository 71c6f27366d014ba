# SPDX-License-Identifier: BSD-2-Clause
"""AZERO in the real gateware: its steps of drive and positions are timed as ``modules/tuner.c`` takes them to be."""

import pytest

from tb.sim.simulator import MS


def gains(sim):
    """KP, KI, KD, KV, KADC and KF of X."""
    return [float(sim.command(f"{name} X?").partition("=")[2]) for name in ("KP", "KI", "KD", "KV", "KA", "KF")]


def test_the_gains_of_the_default_motor_are_found(powered):
    expected = gains(powered)
    assert powered.command("KV X=50") == ":A \r\n"
    assert powered.command("AZ X", timeout_ps=600 * MS) == ":A \r\n"
    assert gains(powered) == pytest.approx(expected, rel=0.04)
    assert powered.command("W X") in (":A 0.0 \r\n", ":A 0.2 \r\n", ":A -0.2 \r\n")
    assert powered.command("DU Y").split()[0] == "0"
