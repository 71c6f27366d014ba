# SPDX-License-Identifier: BSD-2-Clause
"""Encoder edges: times, order, number, phase and index, against positions worked out elsewhere."""

import math
import random

import pytest

from tb.board import plant
from tb.board.board import Board
from tb.board.test_motor import from_rest_at_full_drive

X, Y, Z, F = range(4)
US, MS, S = 10**6, 10**9, 10**12  # ps


def levels(board, axis):
    pins = board.pins
    return pins.enc_a >> axis & 1, pins.enc_b >> axis & 1


def test_edges_come_at_the_closed_form_times():
    """Each edge's time, put into the closed-form motion, gives the position of that edge."""
    board = Board()
    start = plant.load()["x.start_counts"]
    board.drive(X, 1.0)
    expected = math.floor(start)
    for edge in board.edges(30 * MS):
        expected += 1
        assert (edge.axis, edge.direction, edge.count) == (X, 1, expected)
        way, _ = from_rest_at_full_drive(edge.time_ps * 1e-12 - 5e-6)
        assert start + way == pytest.approx(expected, abs=2e-3)
    way, _ = from_rest_at_full_drive(30e-3 - 5e-6)
    assert expected == math.floor(start + way) > 5000


def test_reversals_lose_and_invent_no_edge():
    """Random drives on all axes: A and B, decoded here, follow the true position at every plant step."""
    seed = random.randrange(2**32)
    print(f"seed {seed}")
    choose = random.Random(seed)
    board = Board()
    cycle = [(0, 0), (1, 0), (1, 1), (0, 1)]  # A leads B: positive
    counts = [board.count(axis) for axis in range(4)]
    phases = [cycle.index(levels(board, axis)) for axis in range(4)]
    last_ps, turns = 0, 0
    directions = [0] * 4
    for _ in range(2000):
        board.drive(choose.randrange(4), choose.uniform(-1, 1))
        for edge in board.edges(choose.randrange(1, 200) * 5 * US):
            assert edge.time_ps >= last_ps
            last_ps = edge.time_ps
            assert levels(board, edge.axis) == cycle[(phases[edge.axis] + edge.direction) % 4]
            phases[edge.axis] = (phases[edge.axis] + edge.direction) % 4
            counts[edge.axis] += edge.direction
            turns += directions[edge.axis] == -edge.direction
            directions[edge.axis] = edge.direction
            assert edge.count == counts[edge.axis]
        for axis in range(4):
            assert counts[axis] == board.count(axis) == math.floor(board.position_counts(axis))
            assert phases[axis] == cycle.index(levels(board, axis))
    assert turns > 100


def test_a_leads_b_for_positive_motion():
    board = Board()
    board.drive(X, 1.0)
    rises = []
    before = levels(board, X)
    for _ in board.edges(10 * MS):
        after = levels(board, X)
        rises += [name for name, was, now in zip("AB", before, after) if now and not was]
        if after == (1, 1):
            assert before == (1, 0)
        before = after
    assert rises[:2] == ["A", "B"] and len(rises) > 100


def test_no_axis_starts_on_an_edge_or_in_the_same_phase():
    board = Board()
    fractions = [board.position_counts(axis) % 1 for axis in range(4)]
    assert all(0.1 < fraction < 0.9 for fraction in fractions)
    assert len({levels(board, axis) for axis in range(4)}) > 1


def test_edge_times_spread_over_the_clock():
    board = Board()
    board.drive(X, 0.6)
    bins = [0] * 10
    for edge in board.edges(200 * MS):
        bins[edge.time_ps % 5000 // 500] += 1
    assert sum(bins) > 20_000
    assert all(0.09 < count / sum(bins) < 0.11 for count in bins)


def test_index_is_one_count_wide_once_a_turn():
    board = Board("x.index_counts=1000")
    turn = round(6.35 * 45396 / 4) * 4
    board.drive(X, 1.0)
    high = [edge.count for edge in board.edges(2 * S) if board.pins.enc_z & 1]
    assert high == [1000, 1000 + turn, 1000 + 2 * turn]
    board.drive(X, -1.0)
    high = [edge.count for edge in board.edges(2200 * MS) if board.pins.enc_z & 1]
    assert high == [1000 + 2 * turn, 1000 + turn, 1000]


@pytest.mark.parametrize("wire, mask", [("a", "enc_a"), ("b", "enc_b"), ("z", "enc_z")])
@pytest.mark.parametrize("level", [0, 1])
def test_a_stuck_wire_stays_and_the_stage_moves_on(wire, mask, level):
    board = Board("index_counts=3")
    board.stick_wire(Y, wire, level)
    board.drive(X, 1.0)
    board.drive(Y, 1.0)
    seen = {axis: {getattr(board.pins, mask) >> axis & 1 for edge in board.edges(10 * MS)} for axis in (X, Y)}
    assert seen[Y] == {level}
    assert board.count(Y) > 100
    board.stick_wire(Y, wire, None)
    board.advance(100 * MS)
    assert {getattr(board.pins, mask) >> Y & 1 for edge in board.edges(2 * MS)} == ({0} if wire == "z" else {0, 1})


def test_the_same_calls_give_the_same_edges():
    def run():
        board = Board()
        edges = []
        for n in range(50):
            board.drive(n % 4, math.sin(n))
            edges += [(e.time_ps, e.axis, e.count) for e in board.edges(1234567 * 1000)]
        return edges
    first = run()
    assert len(first) > 1000 and first == run()


def test_advancing_by_large_and_small_steps_is_the_same():
    """The host build's coarse steps see the same stage as the simulator's single events."""
    coarse, fine = Board(), Board()
    for n in range(20):
        drive = math.cos(n)
        coarse.drive(X, drive)
        fine.drive(X, drive)
        coarse.advance(10 * MS)
        for _ in range(1000):
            fine.advance(10 * US)
        assert coarse.count(X) == fine.count(X)
        assert coarse.position_counts(X) == fine.position_counts(X)
