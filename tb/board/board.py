# SPDX-License-Identifier: BSD-2-Clause
"""The board model for Python: builds ``tb/board/*.cpp`` once per content and calls it through ctypes."""

import ctypes
from pathlib import Path

from tb.board import plant
from tb.board.library import build

HERE = Path(__file__).parent
SOURCES = [HERE / name for name in ("board.cpp", "adc.cpp", "axis.cpp", "panel.cpp", "parameters.cpp")]
HEADERS = [HERE / name for name in ("board.h", "adc.h", "axis.h", "panel.h", "parameters.h")]

AXIS_COUNT = 4
INPUTS = {"estop": 0, "in0": 1, "in1": 2}
CONTACTS = {"at": 0, "home": 1, "zero": 2, "joystick": 3, "joystick_wire": 4}
WIRES = {"a": 0, "b": 1, "z": 2}


class Pins(ctypes.Structure):
    """``struct board_pins``; bit n of a mask belongs to axis n."""
    _fields_ = [(name, ctypes.c_uint8) for name in (
        "enc_a", "enc_b", "enc_z", "limit_lower", "limit_upper", "estop", "in0", "in1", "button", "joystick_button",
        "dip", "knob_a", "knob_b", "adc_miso")]


class Edge(ctypes.Structure):
    """``struct board_edge``."""
    _fields_ = [("time_ps", ctypes.c_int64), ("count", ctypes.c_int64),
                ("axis", ctypes.c_uint8), ("direction", ctypes.c_int8)]


def declare(library):
    """Give the functions of board.h in a loaded library their types; returns the library."""
    c, board = ctypes, ctypes.c_void_p
    for name, result, *arguments in (
        ("create", board, c.c_char_p, c.c_char_p, c.c_size_t),
        ("destroy", None, board),
        ("drive", None, board, c.c_int64, c.c_uint, c.c_double),
        ("drive_pins", None, board, c.c_int64, c.c_uint, c.c_uint, c.c_int),
        ("next_ps", c.c_int64, board),
        ("next", c.c_int, board, c.POINTER(Edge)),
        ("advance", None, board, c.c_int64),
        ("pins", c.POINTER(Pins), board),
        ("count", c.c_int64, board, c.c_uint),
        ("position_counts", c.c_double, board, c.c_uint, c.c_int64),
        ("speed_counts_per_s", c.c_double, board, c.c_uint, c.c_int64),
        ("adc_pins", None, board, c.c_int64, c.c_int, c.c_int, c.c_int),
        ("set_input", None, board, c.c_int, c.c_int),
        ("set_contact", None, board, c.c_int64, c.c_int, c.c_int),
        ("set_dip", None, board, c.c_uint),
        ("turn_knob", None, board, c.c_int64, c.c_uint, c.c_int, c.c_int64),
        ("set_analog", None, board, c.c_uint, c.c_double),
        ("cut_pwm", None, board, c.c_uint),
        ("stick_wire", None, board, c.c_uint, c.c_int, c.c_int),
    ):
        function = getattr(library, f"board_{name}")
        function.restype, function.argtypes = result, arguments
    return library


class Hands:
    """What a person can do to a board, and see: shared by :class:`Board` and the simulator.

    Needs ``self._library`` (declared), ``self._board`` (handle) and ``self.time_ps``.
    """

    @property
    def pins(self):
        """The levels now, a :class:`Pins` that follows them."""
        return self._library.board_pins(self._board).contents

    def set_input(self, name, level):
        """Set ``estop``, ``in0`` or ``in1``."""
        self._library.board_set_input(self._board, INPUTS[name], level)

    def set_button(self, name, level):
        """Press or release ``at``, ``home``, ``zero``, ``joystick`` or ``joystick_wire``, now; it bounces."""
        self._library.board_set_contact(self._board, self.time_ps, CONTACTS[name], level)

    def set_dip(self, levels):
        """DIP switches 4, 5, 7, 8 as bits 0 to 3, 1 = on."""
        self._library.board_set_dip(self._board, levels)

    def turn_knob(self, knob, edges, *, interval_ps):
        """Turn knob 0 (control), 1 (X) or 2 (Y) by edges, one every ``interval_ps`` from now on."""
        self._library.board_turn_knob(self._board, self.time_ps, knob, edges, interval_ps)

    def set_analog(self, channel, level):
        """Level of analog input 0 to 7, 0 to 1; they start in the middle."""
        self._library.board_set_analog(self._board, channel, level)

    def cut_pwm(self, axes=range(AXIS_COUNT)):
        """Cut the PWM wires of these axes; ``()`` mends them all."""
        self._library.board_cut_pwm(self._board, sum(1 << axis for axis in axes))

    def stick_wire(self, axis, wire, level):
        """Hold encoder wire ``a``, ``b`` or ``z`` at a level; ``None`` lets it go."""
        self._library.board_stick_wire(self._board, axis, WIRES[wire], -1 if level is None else level)

    def count(self, axis):
        """What an ideal decoder would hold, had it started from the middle of the travel."""
        return self._library.board_count(self._board, axis)

    def position_counts(self, axis):
        """True position now, from the middle of the travel."""
        return self._library.board_position_counts(self._board, axis, self.time_ps)

    def speed_counts_per_s(self, axis):
        """True speed now."""
        return self._library.board_speed_counts_per_s(self._board, axis, self.time_ps)


class Board(Hands):
    """A board by itself, without gateware. ``overrides`` as for :mod:`tb.board.plant`."""

    def __init__(self, *overrides, parameters=None):
        self._library = declare(ctypes.CDLL(str(build("board", SOURCES, headers=HEADERS))))
        text = plant.render(plant.load(overrides)) if parameters is None else parameters
        error = ctypes.create_string_buffer(200)
        self._board = self._library.board_create(text.encode(), error, len(error))
        if not self._board:
            raise ValueError(error.value.decode())
        self.time_ps = 0

    def close(self):
        self._library.board_destroy(self._board)
        self._board = None

    def drive(self, axis, drive):
        """Drive a motor with a fraction of the supply, -1..+1, from now on."""
        self._library.board_drive(self._board, self.time_ps, axis, drive)

    def drive_pins(self, pwm, dir, motor_enable=1):
        """Drive all motors by the levels of the pins from now on."""
        self._library.board_drive_pins(self._board, self.time_ps, pwm, dir, motor_enable)

    def advance(self, duration_ps):
        """Let time pass."""
        self.time_ps += duration_ps
        self._library.board_advance(self._board, self.time_ps)

    def edges(self, duration_ps):
        """Let time pass; yields every encoder edge on the way, the pins as just after it."""
        end_ps = self.time_ps + duration_ps
        while (next_ps := self._library.board_next_ps(self._board)) <= end_ps:
            edge = Edge()
            if self._library.board_next(self._board, edge):
                self.time_ps = next_ps
                yield edge
        self.time_ps = end_ps
