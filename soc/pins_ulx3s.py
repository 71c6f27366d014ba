# SPDX-License-Identifier: BSD-2-Clause
"""What is soldered on the ULX3S, and what must therefore not share a pin.

Sources: amaranth-boards, ``ulx3s.py`` (balls); constraint files v20 and v316, schematics and layout of PCB 2.x, 3.0.x
and 3.1.x at github.com/emard/ulx3s (display header, ESP32 reset of 3.1.x, ADC inputs, what the ESP32 reaches,
position and numbers of the header pins).
"""

from amaranth_boards.ulx3s import ULX3S_85F_Platform

from soc.pins import Facts, Restriction

__all__ = ["FACTS"]


def pairs(*numbers):
    return frozenset(f"g{side}{n}" for n in numbers for side in "pn")


def places():
    """Balls by place."""
    board = ULX3S_85F_Platform
    result = {f"g{'p' if name[-1] == '+' else 'n'}{name[:-1]}": ball
              for name, ball in board.connectors[0].mapping.items()}

    def resource(name, number=0):
        ios = next(r for r in board.resources if (r.name, r.number) == (name, number)).ios
        return {io.name: io.ios[0].names for io in ios} if hasattr(ios[0], "ios") else ios[0].names

    for place, name, number in [("oscillator", "clk25", 0), ("PWR", "button_pwr", 0), ("FIRE1", "button_fire", 0),
                                ("FIRE2", "button_fire", 1), ("UP", "button_up", 0), ("DOWN", "button_down", 0),
                                ("LEFT", "button_left", 0), ("RIGHT", "button_right", 0), ("PROGRAMN", "program", 0),
                                *((f"D{n}", "led", n) for n in range(8)),
                                *((f"SW{n + 1}", "switch", n) for n in range(4))]:
        result[place], = resource(name, number)
    for prefix, name, parts in [
            ("FTDI", "uart", {"TXD": "rx", "RXD": "tx"}),
            ("FLASH", "spi_flash", {"CS": "cs", "D0": "copi", "D1": "cipo", "D2": "wp", "D3": "hold"}),
            ("ADC", "adc", {"CS": "cs", "DIN": "copi", "DOUT": "cipo", "SCLK": "clk"}),
            ("ESP32", "esp32", {"EN": "en", "GPIO0": "gpio0", "GPIO5": "gpio5"})]:
        balls = resource(name)
        for place, part in parts.items():
            result[f"{prefix} {place}"], = balls[part]
    # Not in amaranth-boards.  J5 is unconnected up to PCB 3.0.8; F1 is the ESP32's GPIO0 from 3.1.6 on.
    result |= {"ESP32 EN v3.1": "J5", "SHUTDOWN": "G16",
               "OLED CS": "N2", "OLED DC": "P1", "OLED RES": "P2", "OLED SDA": "P3", "OLED SCL": "P4"}
    return result


def header(first, last, *, left, right, top, middle, bottom, falling):
    """Rows of a header from the side of the USB sockets, as ((number, name), (number, name)); ``left`` and ``right``
    are the sides of the pairs, the groups of seven of which are parted by a row of supply and one of ground."""
    def row(n):
        return f"{left}{n}", f"{right}{n}"

    numbers = list(range(last, first - 1, -1)) if falling else list(range(first, last + 1))
    names = [top, ("GND", "GND"), *map(row, numbers[:7]), *middle, *map(row, numbers[7:]), ("GND", "GND"), bottom]
    return [((39 - 2 * i, a), (40 - 2 * i, b)) if falling else ((2 * i + 2, a), (2 * i + 1, b))
            for i, (a, b) in enumerate(names)]


J1_SUPPLY, SUPPLY, GROUND = ("VCCIO", "VCCIO"), ("3V3", "3V3"), ("GND", "GND")

RESTRICTIONS = (
    Restriction(pairs(14, 15, 16), "inputs AIN0 to AIN5 of the ADC, kept for joystick and detectors", groups=("adc",),
                directions=("in",)),
    Restriction(pairs(17), "inputs AIN6 and AIN7 of the ADC: edges here are noise in the others, so slow contacts only",
                groups=("panel",), directions=("in",)),
    Restriction(pairs(11, 12), "the ESP32 (GPIO26, 25, 33, 32) can drive them until the FPGA is configured and holds it "
                "in reset: contacts behind 1 kilohm only", groups=("panel",), directions=("in",)),
    Restriction(pairs(13), "inputs of the ESP32 (GPIO35, 34) load them: nothing that moves or stops",
                groups=("panel", "serial")),
    Restriction(frozenset({"FLASH CS", "FLASH D0", "FLASH D1", "FLASH D2", "FLASH D3"}),
                "the FPGA configures itself through them", groups=("flash",)),
    Restriction(frozenset({"ESP32 GPIO0", "ESP32 GPIO5"}), "straps of the ESP32"),
    Restriction(frozenset({"PROGRAMN", "SHUTDOWN"}), "would take the configuration or the supply away"),
)

FACTS = Facts(
    places=places(),
    restrictions=RESTRICTIONS,
    held={"ESP32 EN": "the ESP32 shares gp/gn 11 to 13 and must be held in reset",
          "ESP32 EN v3.1": "the ESP32 of PCB 3.1.x must be held in reset"},
    fine_ports=("enc_a", "enc_b", "in0", "in1", "sync_out", "encoder_out", "out0"),
    headers={
        "J1": header(0, 13, left="gp", right="gn", top=J1_SUPPLY, middle=(J1_SUPPLY, GROUND), bottom=J1_SUPPLY,
                     falling=False),
        "J2": header(14, 27, left="gn", right="gp", top=("5V in", "5V out"), middle=(GROUND, SUPPLY), bottom=SUPPLY,
                     falling=True),
    },
    view="seen from above, USB sockets at the top",
)
