# SPDX-License-Identifier: BSD-2-Clause
"""What must hold of a board's pins.  Each rule is a function that yields a sentence for every fault; :data:`RULES`
lists them, and :func:`check` runs them all.

A rule takes a :class:`Case`.
"""

from collections import Counter
from dataclasses import dataclass

from soc.pins import Constraints, Facts

__all__ = ["Case", "RULES", "check"]

FINE_BANKS = 2, 3, 6, 7
"""Left and right: the banks that have IDDRX2F and ODDRX2F (FPGA-TN-02035, "ECP5 and ECP5-5G High-Speed I/O Interface")."""

PULLS = {"pwm": "DOWN", "motor_enable": "DOWN",
         "estop": "UP", "limit_lower": "UP", "limit_upper": "UP", "fault_n": "DOWN", "analog": "NONE"}
"""What an undriven pin has to read or drive, by port: nothing moves, a broken wire stops, no voltage is falsified."""

SETTINGS = {"PULLMODE": ("UP", "DOWN", "NONE"), "IO_TYPE": None, "HYSTERESIS": ("ON",),
            "DRIVE": ("4", "8", "12", "16"), "SLEWRATE": ("SLOW", "FAST")}
NEEDED = {"in": {"PULLMODE", "IO_TYPE"}, "out": {"PULLMODE", "IO_TYPE", "DRIVE", "SLEWRATE"}}
NEEDED["inout"] = NEEDED["out"]
OUTPUT_SETTINGS = {"DRIVE", "SLEWRATE"}


@dataclass(frozen=True)
class Case:
    """A file and what it is held against: the ``ports`` of each top by board, the ``balls`` of each package by
    device, and the :class:`Facts` of the board, or None where nobody has written them down."""
    constraints: Constraints
    ports: dict
    balls: dict
    facts: Facts = None

    def bits(self, board):
        """``{name in the file: direction}`` of a board's top."""
        result = {}
        for port, (direction, width) in self.ports[board].items():
            names = [port] if width == 1 else [f"{port}[{bit}]" for bit in range(width)]
            result.update(dict.fromkeys(names, direction))
        return result


def names_and_balls_are_used_once(case):
    pins = case.constraints.pins
    for word, values in ("port", [p.name for p in pins]), ("ball", [p.ball for p in pins]), (
            "place", [p.place for p in pins]):
        for value, count in Counter(values).items():
            if count > 1:
                yield f"{word} {value} is allotted {count} times"
    for name in case.constraints.repeated:
        yield f"IOBUF of {name} is given twice"


def every_port_has_a_place(case):
    located = {pin.name for pin in case.constraints.pins}
    for board in case.ports:
        for name in case.bits(board):
            if name not in located:
                yield f"port {name} of {board} has no place"


def every_name_is_a_port_or_reserved(case):
    for board in case.ports:
        bits = case.bits(board)
        for pin in case.constraints.pins:
            if pin.name in bits and pin.reserved:
                yield f"{pin.name} is marked reserved, but is a port of {board}"
            if pin.name not in bits and not pin.reserved:
                yield f"{pin.name} is no port of {board}, and not marked reserved"


def directions_are_those_of_the_top(case):
    for board in case.ports:
        bits = case.bits(board)
        for pin in case.constraints.pins:
            if bits.get(pin.name, pin.direction) != pin.direction:
                yield f"{pin.name} is called {pin.direction}, but is {bits[pin.name]} in {board}"


def every_ball_is_an_io(case):
    for device, balls in case.balls.items():
        for pin in case.constraints.pins:
            if pin.ball not in balls:
                yield f"{pin.name}: there is no I/O {pin.ball} in the package of {device}"


def every_pin_has_its_buffer(case):
    names = {pin.name for pin in case.constraints.pins}
    for name in case.constraints.buffers:
        if name not in names:
            yield f"IOBUF for {name}, which has no place"
    types = case.facts.io_types if case.facts else None
    for pin in case.constraints.pins:
        missing = NEEDED[pin.direction] - set(pin.settings)
        if missing:
            yield f"{pin.name} lacks {', '.join(sorted(missing))}"
        if pin.direction == "in" and OUTPUT_SETTINGS & set(pin.settings):
            yield f"{pin.name} is an input and has {', '.join(sorted(OUTPUT_SETTINGS & set(pin.settings)))}"
        for setting, value in pin.settings.items():
            allowed = types if setting == "IO_TYPE" else SETTINGS.get(setting, ())
            if allowed is not None and value not in allowed:
                yield f"{pin.name}: {setting}={value} is not one of {', '.join(allowed) or 'what is known'}"


def pulls_are_safe(case):
    for pin in case.constraints.pins:
        wanted = PULLS.get(pin.port)
        if wanted and pin.settings.get("PULLMODE") != wanted:
            yield f"{pin.name} must have PULLMODE={wanted}: nothing moves, and a wire that breaks stops or says so"


def clocks_are_at_clock_pins(case):
    pins = {pin.name: pin for pin in case.constraints.pins}
    for name in case.constraints.clocks:
        if name not in pins:
            yield f"FREQUENCY of {name}, which has no place"
            continue
        for device, balls in case.balls.items():
            function = balls[pins[name].ball].function if pins[name].ball in balls else ""
            if "PCLK" not in function and "GPLL" not in function:
                yield f"{name} is a clock, but {pins[name].ball} is no clock pin of {device}"


def places_have_the_balls_they_are_said_to_have(case):
    if case.facts:
        for pin in case.constraints.pins:
            if pin.place not in case.facts.places:
                yield f"{pin.name}: the board has no place {pin.place!r}"
            elif case.facts.places[pin.place] != pin.ball:
                yield f"{pin.name}: {pin.place} is ball {case.facts.places[pin.place]}, not {pin.ball}"


def nothing_is_in_conflict_on_the_board(case):
    if case.facts:
        for pin in case.constraints.pins:
            for r in case.facts.restrictions:
                if pin.place in r.places and (pin.group not in r.groups or pin.direction not in r.directions):
                    yield f"{pin.name} ({pin.group}, {pin.direction}) may not be at {pin.place}: {r.reason}"
        driven = {pin.place for pin in case.constraints.pins if pin.direction == "out" and not pin.reserved}
        for place, reason in case.facts.held.items():
            if place not in driven:
                yield f"nothing drives {place}: {reason}"


def fine_ports_are_on_fine_banks(case):
    if case.facts:
        for device, balls in case.balls.items():
            for pin in case.constraints.pins:
                if pin.port in case.facts.fine_ports and pin.ball in balls and balls[pin.ball].bank not in FINE_BANKS:
                    yield f"{pin.name} is on bank {balls[pin.ball].bank} of {device}, which has no IDDRX2F and ODDRX2F"


RULES = (names_and_balls_are_used_once, every_port_has_a_place, every_name_is_a_port_or_reserved,
         directions_are_those_of_the_top, every_ball_is_an_io, every_pin_has_its_buffer, pulls_are_safe,
         clocks_are_at_clock_pins, places_have_the_balls_they_are_said_to_have, nothing_is_in_conflict_on_the_board,
         fine_ports_are_on_fine_banks)


def check(case):
    """Every fault, as a list of sentences."""
    return [fault for rule in RULES for fault in rule(case)]
