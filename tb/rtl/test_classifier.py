# SPDX-License-Identifier: BSD-2-Clause
"""rtl/classifier.py at its pins: random pulse trains, judged by their lengths."""

import os
import random

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

from rtl.classifier import BATCH, CLASSIFIER_LATENCY, DecisionBatch, PulseClassifier

THRESHOLDS = 1, 2, 5, 255, 256, 257, 600


def pulse_train(rng, threshold):
    """``(levels, [(clock that decides, long)])``: pulses around the threshold, and gaps down to one clock."""
    levels, wanted = [0] * 4, []
    for _ in range(60):
        length = max(1, threshold + rng.choice([-threshold + 1, -2, -1, 0, 1, 2, rng.randrange(50)]))
        long = length >= threshold
        wanted.append((len(levels) + (threshold - 1 if long else length), int(long)))
        levels += [1] * length + [0] * rng.choice([1, 1, 2, 3, rng.randrange(1, 40)])
    return levels + [0] * 4, wanted


async def start(dut, *pins):
    cocotb.start_soon(Clock(dut.fast_clk, 5, unit="ns").start())
    dut.fast_rst.value = 1
    for pin in pins:
        pin.value = 0
    for _ in range(2):
        await FallingEdge(dut.fast_clk)
    dut.fast_rst.value = 0
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    return random.Random(seed)


async def decisions(dut, levels):
    """``[(clock that decided, long)]`` of these levels, one a clock."""
    seen = []
    for clock, level in enumerate(levels):
        dut.level.value = level
        if dut.decided.value:
            seen.append((clock - CLASSIFIER_LATENCY, int(dut.long.value)))
        await FallingEdge(dut.fast_clk)
    return seen


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def every_pulse_is_judged_by_its_length(dut):
    threshold = int(os.environ["THRESHOLD"])
    rng = await start(dut, dut.level)
    dut.settings.value = 0b10 << 32 | threshold
    levels, wanted = pulse_train(rng, threshold)
    seen = await decisions(dut, levels)
    assert seen == wanted and {long for _, long in wanted} == ({0, 1} if threshold > 1 else {1})


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def at_the_threshold_the_level_decides(dut):
    threshold = int(os.environ["THRESHOLD"])
    rng = await start(dut, dut.level)
    dut.settings.value = 0b11 << 32 | threshold
    levels = [0] * 4
    for _ in range(200):
        levels += [1 - levels[-1]] * rng.randint(1, threshold + 3)
    wanted, clock = [], 1
    while clock + threshold < len(levels) - CLASSIFIER_LATENCY:
        if levels[clock] and not levels[clock - 1]:
            clock += threshold - 1
            wanted.append((clock, levels[clock]))
        clock += 1
    seen = await decisions(dut, levels)
    assert seen[:len(wanted)] == wanted and len(wanted) > 10 and len(seen) <= len(wanted) + 2


def test_classifier(simulate):
    for threshold in THRESHOLDS:
        simulate(PulseClassifier(), tests="every_pulse|at_the", env={"THRESHOLD": str(threshold)})


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def batches_hold_all_decisions_in_order(dut):
    """A queue that is emptied now and then; what comes when eight wait is counted."""
    rng = await start(dut, dut.decided, dut.long, dut.take)
    queue, lost = [], 0
    for _ in range(5000):
        decided, long, take = rng.random() < 0.4, rng.randrange(2), rng.random() < 0.07
        dut.decided.value, dut.long.value, dut.take.value = decided, long, take
        text = bin(dut.batch.value.to_unsigned())[3:]
        assert text == "".join(map(str, queue)) and dut.waiting.value == bool(queue)
        assert dut.lost.value.to_unsigned() == lost
        if take:
            queue = []
        if decided and len(queue) < BATCH:
            queue.append(long)
        elif decided:
            lost += 1
        await FallingEdge(dut.fast_clk)
    assert lost > 50


def test_batch(simulate):
    simulate(DecisionBatch(), tests="batches")
