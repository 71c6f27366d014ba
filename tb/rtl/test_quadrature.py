# SPDX-License-Identifier: BSD-2-Clause
"""rtl/quadrature.py: the decoder follows the encoder model sample by sample."""

import random

import cocotb
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
from cocotb.utils import get_sim_time

from rtl.quadrature import DECODER_LATENCY, QuadratureDecoder
from tb.models.encoder import Encoder, Expected, Wire

PERIOD_PS = 5000


async def start(dut, *, filter=0, invert=0, encoder=None, reset_clocks=4):
    """Reset with the pins at rest; return the encoder and the time: it may move from now on."""
    encoder = encoder or Encoder()
    dut.fast_rst.value = 1
    dut.settings.value = invert << 4 | filter
    for name in "abz":
        getattr(dut, name).value = getattr(encoder, name).level
    cocotb.start_soon(Clock(dut.fast_clk, PERIOD_PS, unit="ps").start())
    await ClockCycles(dut.fast_clk, reset_clocks)
    await FallingEdge(dut.fast_clk)
    dut.fast_rst.value = 0
    await ClockCycles(dut.fast_clk, 8)
    return encoder, round(get_sim_time("ps"))


async def drive(dut, encoder):
    """Move the pins as the encoder's wires move, at their times."""
    for time, name, level in encoder.events:
        if (wait := time - round(get_sim_time("ps"))) > 0:
            await Timer(wait, unit="ps")
        getattr(dut, name).value = level


def shown(dut):
    return Expected(
        count=dut.steps__count.value.to_signed(),
        moved=bool(dut.steps__moved.value), up=bool(dut.steps__up.value),
        a=int(dut.steps__a.value), error=bool(dut.error.value), errors=dut.errors.value.to_unsigned(),
        index=bool(dut.index.value), index_count=dut.index_count.value.to_signed())


async def record(dut, encoder, *, extra=40):
    """Drive the encoder; return the sampling times, and what the outputs showed after each."""
    times, outputs = [], []
    moving = cocotb.start_soon(drive(dut, encoder))
    while extra:
        await RisingEdge(dut.fast_clk)
        times.append(round(get_sim_time("ps")))
        await FallingEdge(dut.fast_clk)
        outputs.append(shown(dut))
        extra -= moving.done()
    return times, outputs


def check(times, outputs, expected):
    """Each sample shows DECODER_LATENCY clocks later; results that are latched by a strobe one more."""
    for n, want in enumerate(expected[:-DECODER_LATENCY - 1]):
        got, later = outputs[n + DECODER_LATENCY], outputs[n + DECODER_LATENCY + 1]
        if not want.moved:
            want.up = got.up
        got.errors, got.index_count = later.errors, later.index_count
        assert got == want, f"sample at {times[n]} ps"


def random_motion(encoder, start_ps, *, clock_ps, steps, rng, least_ps, most_ps, reversal=0.05, index=0.05):
    """Edges at random times at least ``least_ps`` apart, with reversals and index pulses.

    ``clock_ps``: time of a clock edge.  Nothing moves on one: what is sampled there is anybody's guess.
    """
    def off_the_edges(time):
        return time + ((time - clock_ps) % PERIOD_PS == 0)

    time, direction = start_ps, 1
    z_time = encoder.z.events[-1][0] if encoder.z.events else start_ps
    for _ in range(steps):
        time = off_the_edges(time + round(least_ps + (most_ps - least_ps) * rng.random() ** 3))
        if rng.random() < reversal:
            direction = -direction
        encoder.step(time, direction)
        if rng.random() < index and time > z_time:
            z_time = off_the_edges(time + rng.randrange(300, 12 * PERIOD_PS))
            encoder.z.toggle(z_time)


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(filter=[0, 1, 3, 7, 15], invert=[0, 1])
async def follows_the_model_sample_by_sample(dut, filter, invert):
    rng = random.Random(seed := 1000 + 2 * filter + invert)
    dut._log.info("seed %d", seed)
    encoder, now = await start(dut, filter=filter, invert=invert)
    # Legal edges at any phase, then edges so close that some are illegal or shorter than the filter.
    random_motion(encoder, now + 2 * PERIOD_PS, clock_ps=now, steps=500, rng=rng,
                  least_ps=(filter + 1) * PERIOD_PS, most_ps=(filter + 9) * PERIOD_PS)
    legal = encoder.position
    random_motion(encoder, encoder.events[-1][0] + 20 * PERIOD_PS, clock_ps=now, steps=700, rng=rng,
                  least_ps=300, most_ps=4 * (filter + 1) * PERIOD_PS, reversal=0.2)
    times, outputs = await record(dut, encoder)
    expected = encoder.expected(times, filter=filter, invert=invert)
    check(times, outputs, expected)
    # The stimulus was worth it: the legal part is exact by position, and all kinds of sample occurred.
    if filter == 0:
        assert any(e.count == (-legal if invert else legal) for e in expected if not e.errors)
    assert expected[-1].errors > 5 and sum(e.index for e in expected) > 5
    assert any(e.moved and e.up for e in expected) and any(e.moved and not e.up for e in expected)


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def a_filter_set_while_moving_costs_no_count(dut):
    """Edges as close as the longest filter allows; the filter changes at any clock between them."""
    rng = random.Random(seed := 77)
    dut._log.info("seed %d", seed)
    encoder, now = await start(dut)
    time, direction = now, 1
    for _ in range(4000):
        time += rng.randrange(17 * PERIOD_PS // 2, 12 * PERIOD_PS)      # 16 clocks and more on each channel
        if rng.random() < 0.02:
            time, direction = time + 20 * PERIOD_PS, -direction
        encoder.step(time + ((time - now) % PERIOD_PS == 0), direction)
    moving, changes = cocotb.start_soon(drive(dut, encoder)), 0
    while not moving.done():
        await ClockCycles(dut.fast_clk, rng.randrange(5, 60), FallingEdge)
        dut.settings.value = rng.choice([0, 1, 4, 8, 14, 15, 15, 15])
        changes += 1
    dut.settings.value = 0
    await ClockCycles(dut.fast_clk, 40)
    assert changes > 400
    assert dut.errors.value == 0 and dut.steps__count.value.to_signed() == encoder.position


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(direction=[1, -1], phase_ps=[1, 1700, 4999])
async def counts_one_edge_per_clock(dut, direction, phase_ps):
    encoder, now = await start(dut)
    for n in range(400):
        encoder.step(now + (n + 2) * PERIOD_PS + phase_ps, direction)
    times, outputs = await record(dut, encoder, extra=8)
    check(times, outputs, encoder.expected(times))
    assert sum(o.moved for o in outputs) == 400
    assert outputs[-1].count == 400 * direction and outputs[-1].errors == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(filter=[0, 1, 3, 15])
async def an_edge_shows_after_the_latency_and_the_filter(dut, filter):
    encoder, now = await start(dut, filter=filter)
    encoder.step(now + 1, 1)
    _, outputs = await record(dut, encoder)
    assert [o.moved for o in outputs].index(True) == 3 + filter
    assert [o.count for o in outputs].index(1) == 3 + filter
    assert [o.a for o in outputs].index(1) == 3 + filter
    assert sum(o.moved for o in outputs) == 1


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(filter=[1, 2, 3, 8, 15], wire=["a", "b", "z"])
async def a_pulse_as_long_as_the_filter_vanishes_a_longer_one_does_not(dut, filter, wire):
    encoder, now = await start(dut, filter=filter)
    for length, gap in (filter, 40), (filter + 1, 40), (filter, 1), (filter, 40):
        getattr(encoder, wire).toggle(now + 1)
        getattr(encoder, wire).toggle(now + 1 + length * PERIOD_PS)
        now += (length + gap) * PERIOD_PS
    _, outputs = await record(dut, encoder)
    happened = [n for n, o in enumerate(outputs) if (o.index if wire == "z" else o.moved)]
    rises = filter + 40 + DECODER_LATENCY + filter
    assert happened == ([rises] if wire == "z" else [rises, rises + filter + 1])
    assert outputs[-1].count == 0 and outputs[-1].errors == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(place=[0, 1, 2, 3], filter=[0, 15], reset_clocks=[1, 4])
async def levels_at_reset_make_no_step(dut, place, filter, reset_clocks):
    before, encoder = Encoder((place + 2) % 4), Encoder(place)
    encoder.z = Wire(1)
    starting = cocotb.start_soon(start(dut, filter=filter, encoder=before, reset_clocks=reset_clocks))
    await FallingEdge(dut.fast_rst)
    # All pins change as reset ends: what the first clock samples is where counting starts from.
    for name in "abz":
        getattr(dut, name).value = getattr(encoder, name).level
    for _ in range(40):
        await FallingEdge(dut.fast_clk)
        now = shown(dut)
        assert not (now.moved or now.error or now.index) and now.count == now.errors == now.index_count == 0
    await starting
    # What comes after counts from there.
    encoder.step(round(get_sim_time("ps")) + 1, 1)
    _, outputs = await record(dut, encoder)
    assert outputs[-1].count == 1 and outputs[-1].errors == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def an_illegal_transition_is_an_error_and_no_step(dut):
    encoder, now = await start(dut)
    for n in range(3):
        encoder.a.toggle(now + 1 + 10 * n * PERIOD_PS)
        encoder.b.toggle(now + 2 + 10 * n * PERIOD_PS)
    _, outputs = await record(dut, encoder)
    assert [n for n, o in enumerate(outputs) if o.error] == [3, 13, 23]
    assert [o.errors for o in outputs].index(1) == 4 and outputs[-1].errors == 3
    assert not any(o.moved for o in outputs) and outputs[-1].count == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def errors_stay_at_65535(dut):
    await start(dut)
    await Timer(1234, unit="ps")
    for pin in dut.a, dut.b:
        cocotb.start_soon(Clock(pin, 2 * PERIOD_PS, unit="ps").start())
    await ClockCycles(dut.fast_clk, 65530)
    assert 65500 < dut.errors.value.to_unsigned() < 65535
    await ClockCycles(dut.fast_clk, 100)
    assert dut.errors.value.to_unsigned() == 65535
    assert dut.steps__count.value.to_signed() == 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_new_setting_makes_no_step(dut):
    encoder, now = await start(dut)
    encoder.step(now + 1, 1)
    await record(dut, encoder, extra=8)
    for settings in 0x1f, 0x00, 0x10, 0x0f, 0x03, 0x00:
        dut.settings.value = settings
        for _ in range(20):
            await FallingEdge(dut.fast_clk)
            assert not dut.steps__moved.value and dut.steps__count.value.to_signed() == 1


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(direction=[1, -1])
async def the_count_wraps(dut, direction):
    width = len(dut.steps__count)           # the full width wraps in the proof, tb/formal/quadrature.py
    encoder, now = await start(dut)
    for n in range(3 << width - 1):
        encoder.step(now + (n + 2) * PERIOD_PS + 77, direction)
    times, outputs = await record(dut, encoder, extra=8)
    check(times, outputs, encoder.expected(times, width=width))
    assert {o.count for o in outputs} == set(range(-1 << width - 1, 1 << width - 1))


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def edges_two_clocks_apart_count_however_late_synchronisers_are(dut):
    rng = random.Random(77)
    encoder, now = await start(dut)
    random_motion(encoder, now + 2 * PERIOD_PS, clock_ps=now, steps=600, rng=rng,
                  least_ps=2 * PERIOD_PS, most_ps=6 * PERIOD_PS)
    times, outputs = await record(dut, encoder)
    assert outputs[-1].count == encoder.position and outputs[-1].errors == 0
    # Each step comes in order, at its latency or one clock later.
    wanted = [n for n, e in enumerate(encoder.expected(times)) if e.moved]
    came = [n for n, o in enumerate(outputs) if o.moved]
    assert {c - w for c, w in zip(came, wanted, strict=True)} <= {DECODER_LATENCY, DECODER_LATENCY + 1}


def test_decoder(simulate):
    simulate(QuadratureDecoder(), tests="^(?!.*the_count_wraps)")


def test_decoder_with_late_synchronisers(simulate):
    simulate(QuadratureDecoder(), random_delay=True, tests="however_late|levels_at_reset")


@pytest.mark.parametrize("width", [2, 9])
def test_narrow_decoder(simulate, width):
    simulate(QuadratureDecoder(width=width), tests="the_count_wraps")


def test_width_is_checked():
    with pytest.raises(ValueError, match="at least 2 bits, not 1"):
        QuadratureDecoder(width=1)
