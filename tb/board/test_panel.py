# SPDX-License-Identifier: BSD-2-Clause
"""Buttons bounce and come to rest, knobs go round, and the converter does what its data sheet says."""

import random

import pytest

from tb.board.board import Board
from tb.models.adc import Adc
from tb.models.encoder import CIRCLE

NS, US, MS = 10**3, 10**6, 10**9
BOUNCE_PS = 4 * MS


def watch(board, pins, duration_ps, step_ps):
    """The levels of some pins, as a tuple, every step."""
    for _ in range(duration_ps // step_ps):
        board.advance(step_ps)
        yield tuple(getattr(board.pins, pin) for pin in pins)


def changes(levels):
    return sum(a != b for a, b in zip(levels, levels[1:]))


@pytest.mark.parametrize("name, pin, bit", [
    ("at", "button", 0), ("home", "button", 1), ("zero", "button", 2), ("joystick", "button", 3),
    ("joystick_wire", "joystick_button", 0)])
def test_a_button_bounces_and_comes_to_rest(name, pin, bit):
    board, most = Board(), 0
    for n in range(20):
        level = 1 - n % 2
        board.set_button(name, level)
        bouncing = [values[0] for values in watch(board, (pin,), BOUNCE_PS, 2 * US)]
        assert {values[0] for values in watch(board, (pin,), BOUNCE_PS, 20 * US)} == {level << bit}
        assert changes(bouncing) % 2 == 0 and bouncing[0] == level << bit
        most = max(most, changes(bouncing))
    assert 4 <= most <= 8


def test_a_button_let_go_while_it_bounces_ends_up():
    board = Board()
    for _ in range(20):
        board.set_button("zero", 1)
        board.advance(MS)
        board.set_button("zero", 0)
        board.advance(BOUNCE_PS)
        assert board.pins.button == 0


def test_dip_switches_are_as_set():
    board = Board()
    assert board.pins.dip == 0
    for levels in range(16):
        board.set_dip(levels)
        assert board.pins.dip == levels


@pytest.mark.parametrize("knob", range(3))
def test_a_knob_goes_round_the_circle(knob):
    board, place = Board("knob_bounce_us=0"), 0
    for edges in (5, -9, 14, -1):
        board.turn_knob(knob, edges, interval_ps=100 * US)
        board.advance(50 * US)
        for _ in range(abs(edges)):
            place += 1 if edges > 0 else -1
            assert (board.pins.knob_a, board.pins.knob_b) == tuple(int(c) << knob for c in CIRCLE[place % 4])
            board.advance(100 * US)
        board.advance(50 * US)


def test_a_knob_bounces_between_two_places_only():
    board, place, seen = Board(), 0, 0
    for _ in range(200):
        board.turn_knob(1, 1, interval_ps=100 * US)
        levels = list(watch(board, ("knob_a", "knob_b"), 20 * US, 100 * NS))
        allowed = {tuple(int(c) << 1 for c in CIRCLE[p % 4]) for p in (place, place + 1)}
        place += 1
        assert set(levels) <= allowed and levels[-1] == tuple(int(c) << 1 for c in CIRCLE[place % 4])
        seen += changes(levels) > 0
    assert seen > 100


class Spi:
    """A host that moves the pins of both converters, C++ and Python, and compares what they say."""

    def __init__(self, board, adc):
        self.board, self.adc = board, adc
        self.put(1, 0, 0)

    def put(self, cs_n, sck, mosi):
        board = self.board
        board._library.board_adc_pins(board._board, board.time_ps, cs_n, sck, mosi)
        self.adc.pins(board.time_ps / NS, cs_n, sck, mosi)
        board.advance(80 * NS)
        level = self.adc.dout(board.time_ps / NS)
        assert board.pins.adc_miso == level
        return level

    def frame(self, word):
        """Exchange 16 bits, SCLK idle low."""
        self.put(0, 0, 0)
        result = 0
        for bit in reversed(range(16)):
            mosi = word >> bit & 1
            level = self.put(0, 0, mosi)
            self.put(0, 1, mosi)
            result = result << 1 | level
        self.put(0, 0, 0)
        self.put(1, 0, 0)
        return result


def test_the_converter_is_the_model_s_twin():
    seed = random.randrange(2**32)
    print(f"seed {seed}")
    choose = random.Random(seed)
    board, adc = Board(), Adc()
    adc.inputs = [0.5] * 8
    spi, answers = Spi(board, adc), set()
    for _ in range(400):
        if choose.random() < 0.3:
            channel, level = choose.randrange(8), choose.uniform(-0.1, 1.1)
            board.set_analog(channel, level)
            adc.inputs[channel] = level
        word = choose.choice([0x0806 | choose.randrange(8) << 7, 0x0802 | choose.randrange(8) << 7, 0x0000, 0x8800,
                              0x9000, 0x0040 if choose.random() < 0.1 else 0x0000])
        answers.add(spi.frame(word))
    assert len(answers) > 50


def test_the_output_follows_within_the_data_sheet_s_time():
    board = Board()
    library, handle = board._library, board._board
    assert board.pins.adc_miso == 1
    library.board_adc_pins(handle, board.time_ps, 0, 0, 0)       # selected, nothing converted: 0
    board.advance(15 * NS)
    assert board.pins.adc_miso == 1
    board.advance(1 * NS)
    assert board.pins.adc_miso == 0
