# SPDX-License-Identifier: BSD-2-Clause
"""What is soldered on the ECPIX-5.

Sources: amaranth-boards, ``ecpix5.py`` (balls); docs.lambdaconcept.com/ecpix-5, pages PMOD (nothing else is at these
pins), LEDs (names), Debug (directions of the serial port); the package's data base in nextpnr (the flash: which balls the
FPGA is configured by is its own matter; amaranth-boards exchanges D0 and D1); Digilent, "Pmod Interface Specification 1.2.0" (the 12-pin
port).
"""

from amaranth_boards.ecpix5 import ECPIX585Platform

from soc.pins import Facts, Restriction

__all__ = ["FACTS"]

PMODS = 8


def places():
    """Balls by place."""
    board = ECPIX585Platform
    result = {f"PMOD{pmod.number}-{pin}": ball for pmod in board.connectors for pin, ball in pmod.mapping.items()}

    def resource(name, number=0):
        ios = next(r for r in board.resources if (r.name, r.number) == (name, number)).ios
        return {io.name: io.ios[0].names for io in ios} if hasattr(ios[0], "ios") else ios[0].names

    result["oscillator"], = resource("clk100")
    result["RESET"], = resource("rst")
    for place, part in ("FTDI TXD", "rx"), ("FTDI RXD", "tx"):
        result[place], = resource("uart")[part]
    result |= {"FLASH CS": "AA2", "FLASH D0": "AE2", "FLASH D1": "AD2", "FLASH D2": "AF2", "FLASH D3": "AE1"}
    for n in range(4):
        for colour in "red", "green", "blue":
            result[f"LD{n + 5} {colour}"], = resource("rgb_led", n)[colour[0]]
    return result


def port(pmod):
    """Rows of a 12-pin port: pins 1 to 6 left, 7 to 12 right."""
    names = {5: "GND", 6: "3V3", 11: "GND", 12: "3V3"}
    return [tuple((pin, names.get(pin, f"PMOD{pmod}-{pin}")) for pin in (n, n + 6)) for n in range(1, 7)]


FACTS = Facts(
    places=places(),
    restrictions=(Restriction(frozenset({"FLASH CS", "FLASH D0", "FLASH D1", "FLASH D2", "FLASH D3"}),
                              "the FPGA configures itself through them", groups=("flash",)),),
    fine_ports=("enc_a", "enc_b", "in0", "in1", "sync_out", "encoder_out", "out0"),
    headers={f"PMOD{n}": port(n) for n in range(PMODS)},
    view="pins 1 to 6 at the left, 7 to 12 at the right",
)
