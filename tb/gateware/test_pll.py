# SPDX-License-Identifier: BSD-2-Clause
"""soc/ecp5.py: the PLL makes exactly 50 and 200 MHz, within its ranges, for the oscillators boards have."""

from fractions import Fraction

import pytest

from soc import gateware
from soc.ecp5 import Board, ClockGenerator, PllSettings
from soc.top import CLOCK_HZ, FAST_CLOCK_HZ


def outputs(input_hz, p):
    """Frequencies that the parameters of the primitive make: FPGA-TN-02200, "PLL Divider Settings": the VCO settles
    where output 0, divided by the feedback divider, is the input divided by its own."""
    vco = Fraction(input_hz * p["CLKFB_DIV"] * p["CLKOP_DIV"], p["CLKI_DIV"])
    return vco, [vco / p[f"{name}_DIV"] for name in ("CLKOP", "CLKOS") if p[f"{name}_ENABLE"] == "ENABLED"]


@pytest.mark.parametrize("input_hz", [20_000_000, 25_000_000, 60_000_000, 100_000_000])
def test_the_clocks_are_exact(input_hz):
    settings = PllSettings.find(input_hz, (FAST_CLOCK_HZ, CLOCK_HZ))
    parameters = settings.parameters()
    vco, frequencies = outputs(input_hz, parameters)
    assert frequencies == [200_000_000, 50_000_000] == list(settings.outputs_hz)
    assert 400_000_000 <= vco <= 800_000_000 and vco == settings.vco_hz
    assert 10_000_000 <= Fraction(input_hz, parameters["CLKI_DIV"])
    assert parameters["FEEDBK_PATH"] == "CLKOP"
    # Both dividers start one period of the VCO before their first rising edge.
    for name in "CLKOP", "CLKOS":
        assert parameters[f"{name}_CPHASE"] + 1 == parameters[f"{name}_DIV"]


def test_of_25_mhz_the_product():
    settings = PllSettings.find(25_000_000, (200_000_000, 50_000_000))
    assert (settings.input_divider, settings.feedback_divider, settings.output_dividers) == (1, 8, (3, 12))


@pytest.mark.parametrize("input_hz, outputs_hz", [
    (25_000_000, (200_000_000, 33_000_000)), (33_333_333, (200_000_000,)), (7_000_000, (50_000_000,)),
    (25_000_000, (500_000_000,)), (25_000_000, (3_000_000,))])
def test_what_it_cannot_make_is_refused(input_hz, outputs_hz):
    with pytest.raises(ValueError, match="no setting of the PLL"):
        PllSettings.find(input_hz, outputs_hz)


def test_every_board_has_clocks_and_constraints():
    known = gateware.boards()
    assert {"ulx3s-85f", "ulx3s-25f"} <= set(known)
    for board in known.values():
        assert issubclass(board, Board)
        ClockGenerator(input_hz=board.oscillator[1], sync_hz=CLOCK_HZ, fast_hz=FAST_CLOCK_HZ)
        assert gateware.Flow(board).constraints.exists()
