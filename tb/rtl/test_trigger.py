# SPDX-License-Identifier: BSD-2-Clause
"""rtl/trigger.py between a synchroniser and real decoders: pins in, and records of where the pins were."""

import random

import cocotb
from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

from rtl.quadrature import QuadratureDecoder
from rtl.trigger import MINIMUM, TriggerCapture
from tb.models.encoder import CIRCLE

AXES = 4
FILTERS = 0, 1, 9, 15


class Bench(wiring.Component):
    """The capture as it is wired to the pins: four decoders, each with a filter of its own."""

    def __init__(self):
        self._capture = TriggerCapture(axes=AXES)
        super().__init__({
            "pin": In(1), "a": In(AXES), "b": In(AXES), "minimum": In(8), "ready": In(1),
            "time": Out(64), "record": Out(1), "missed": Out(1), "moment": Out(64),
            **{f"count{n}": Out(32) for n in range(AXES)},
        })

    def elaborate(self, platform):
        m = Module()
        m.submodules.capture = capture = self._capture
        m.submodules.sync = FFSynchronizer(self.pin, capture.level, o_domain="fast")
        m.d.fast += self.time.eq(self.time + 1)
        m.d.comb += [
            capture.settings.minimum.eq(self.minimum), capture.settings.enable.eq(1), capture.ready.eq(self.ready),
            capture.time.eq(self.time), self.record.eq(capture.record), self.missed.eq(capture.missed),
            self.moment.eq(capture.moment),
        ]
        for n, samples in enumerate(FILTERS):
            decoder = QuadratureDecoder()
            m.submodules[f"decoder{n}"] = decoder
            m.d.comb += [
                decoder.a.eq(self.a[n]), decoder.b.eq(self.b[n]), decoder.settings.filter.eq(samples),
                capture.filter[n].eq(samples), capture.count[n].eq(decoder.steps.count),
                getattr(self, f"count{n}").eq(capture.counts[n]),
            ]
        return m


class Pins:
    """All pins, moved at once before a sample: the axes walk as fast as their filters follow."""

    def __init__(self, dut, rng):
        self.dut, self.rng = dut, rng
        self.places, self.rest = [0] * AXES, [0] * AXES

    async def sample(self, pin, ready=1):
        for n, samples in enumerate(FILTERS):
            self.rest[n] -= 1
            if self.rest[n] < 0 and self.rng.random() < 0.8:
                self.places[n] += self.rng.choice([1, 1, 1, -1])
                self.rest[n] = samples
        for name, bit in ("a", 0), ("b", 1):
            getattr(self.dut, name).value = sum(int(CIRCLE[p % 4][bit]) << n for n, p in enumerate(self.places))
        self.dut.pin.value, self.dut.ready.value = pin, ready
        places = tuple(self.places)
        await FallingEdge(self.dut.fast_clk)
        return places


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def records_are_where_the_pins_were(dut):
    cocotb.start_soon(Clock(dut.fast_clk, 5, unit="ns").start())
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    rng = random.Random(seed)
    dut.fast_rst.value, dut.minimum.value, dut.pin.value = 1, MINIMUM, 0
    dut.a.value = dut.b.value = sum(int(CIRCLE[0][0]) << n for n in range(AXES))
    for _ in range(3):
        await FallingEdge(dut.fast_clk)
    dut.fast_rst.value = 0
    pins, wanted, seen, missed, clock = Pins(dut, rng), [], [], 0, 0
    pins.rest = [60] * AXES                 # the decoders find their pins first

    async def hold(pin, clocks, ready=1):
        nonlocal missed, clock
        first = None
        for _ in range(clocks):
            # ``time`` is what the capture sees in this clock, whose end takes the sample.
            places = await pins.sample(pin, ready)
            first = first or (places, clock)
            clock += 1
            if dut.record.value:
                seen.append((tuple(getattr(dut, f"count{n}").value.to_signed() for n in range(AXES)),
                             dut.moment.value.to_unsigned()))
            missed += int(dut.missed.value)
        return first

    await hold(0, 80)
    rises_missed = 0
    for _ in range(400):
        kind = rng.random()
        if kind < 0.2:                                          # a glitch
            await hold(1, rng.randrange(1, MINIMUM))
            await hold(0, rng.randrange(1, 5))
        elif kind < 0.3:                                        # nobody takes it
            await hold(1, rng.randrange(3, 40), ready=0)
            await hold(0, MINIMUM + 3, ready=0)
            rises_missed += 1
        else:
            places, at = await hold(1, rng.choice([MINIMUM, MINIMUM + 1, rng.randrange(MINIMUM, 60)]))
            wanted.append((places, at + 3))
            while rng.random() < 0.3:                           # bounces as it falls: not another pulse
                await hold(0, rng.randrange(1, MINIMUM))
                await hold(1, rng.randrange(1, 30))
            await hold(0, rng.choice([MINIMUM, rng.randrange(MINIMUM, 60)]))
    await hold(0, 40)
    assert seen == wanted and len(wanted) > 200
    assert missed == rises_missed > 20


def test_trigger(simulate):
    simulate(Bench(), tests="records")
