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

from rtl.quadrature import FILTER_BITS, QuadratureDecoder
from rtl.trigger import MINIMUM, TriggerCapture
from tb.models.encoder import CIRCLE

AXES = 4
FILTERS = 1 << FILTER_BITS
STEP = 0x9e37_79b9_7f4a_7c15        # of the time, in each clock: every bit of it moves


class Bench(wiring.Component):
    """The capture as it is wired to the pins: four decoders, each with a filter of its own."""

    def __init__(self):
        self._capture = TriggerCapture(axes=AXES)
        super().__init__({
            "pin": In(1), "a": In(AXES), "b": In(AXES), "minimum": In(8),
            "time": Out(64), "record": Out(1), "moment": Out(64),
            **{f"filter{n}": In(FILTER_BITS) for n in range(AXES)}, **{f"count{n}": Out(32) for n in range(AXES)},
        })

    def elaborate(self, platform):
        m = Module()
        m.submodules.capture = capture = self._capture
        m.submodules.sync = FFSynchronizer(self.pin, capture.level, o_domain="fast")
        m.d.fast += self.time.eq(self.time + STEP)
        m.d.comb += [
            capture.settings.minimum.eq(self.minimum), capture.settings.enable.eq(1),
            capture.time.eq(self.time), self.record.eq(capture.record), self.moment.eq(capture.o.moment),
        ]
        for n in range(AXES):
            decoder = QuadratureDecoder()
            m.submodules[f"decoder{n}"] = decoder
            m.d.comb += [
                decoder.a.eq(self.a[n]), decoder.b.eq(self.b[n]),
                decoder.settings.filter.eq(getattr(self, f"filter{n}")),
                capture.filter[n].eq(decoder.filter), capture.count[n].eq(decoder.steps.count),
                getattr(self, f"count{n}").eq(capture.o.counts[n]),
            ]
        return m


class Pins:
    """All pins, moved at once before a sample: the axes walk as fast as their filters follow.

    ``wanted`` are the records to come, ``seen`` those that came: (places, time).
    """

    def __init__(self, dut, rng):
        self.dut, self.rng, self.clock = dut, rng, 0
        self.places, self.rest, self.filters = [0] * AXES, [0] * AXES, [0] * AXES
        self.wanted, self.seen = [], []

    async def start(self):
        dut = self.dut
        cocotb.start_soon(Clock(dut.fast_clk, 5, unit="ns").start())
        dut.fast_rst.value, dut.minimum.value, dut.pin.value = 1, MINIMUM, 0
        dut.a.value = dut.b.value = 0
        for n in range(AXES):
            getattr(dut, f"filter{n}").value = 0
        for _ in range(3):
            await FallingEdge(dut.fast_clk)
        dut.fast_rst.value = 0
        await self.hold(0, 20, still=True)              # the decoders find their pins first

    async def _sample(self, pin, still):
        for n, samples in enumerate(self.filters):
            self.rest[n] -= 1
            if not still and self.rest[n] < 0 and self.rng.random() < 0.8:
                self.places[n] += self.rng.choice([1, 1, 1, -1])
                self.rest[n] = samples
        for name, bit in ("a", 0), ("b", 1):
            getattr(self.dut, name).value = sum(int(CIRCLE[p % 4][bit]) << n for n, p in enumerate(self.places))
        self.dut.pin.value = pin
        places = tuple(self.places)
        await FallingEdge(self.dut.fast_clk)
        return places

    async def hold(self, pin, clocks, still=False):
        """Keep the trigger's pin; the record of a pulse that would begin with this."""
        first = None
        for _ in range(clocks):
            # ``time`` is what the capture sees in this clock, whose end takes the sample; 3 clocks later it is kept.
            places = await self._sample(pin, still)
            first = first or (places, (self.clock + 3) * STEP % (1 << 64))
            self.clock += 1
            if self.dut.record.value:
                self.seen.append((tuple(getattr(self.dut, f"count{n}").value.to_signed() for n in range(AXES)),
                                  self.dut.moment.value.to_unsigned()))
        return first

    async def set_filters(self, filters):
        """At rest, as the decoders take them."""
        await self.hold(0, FILTERS + 4, still=True)
        for n, samples in enumerate(filters):
            getattr(self.dut, f"filter{n}").value = samples
        self.filters = list(filters)
        await self.hold(0, 6, still=True)

    async def pulse(self):
        rng = self.rng
        self.wanted.append(await self.hold(1, rng.choice([MINIMUM, MINIMUM + 1, rng.randrange(MINIMUM, 60)])))
        while rng.random() < 0.3:                       # bounces as it falls: not another pulse
            await self.hold(0, rng.randrange(1, MINIMUM))
            await self.hold(1, rng.randrange(1, 30))
        await self.hold(0, rng.choice([MINIMUM, rng.randrange(MINIMUM, 60)]))


async def begin(dut):
    seed = random.randrange(1 << 32)
    dut._log.info(f"seed {seed}")
    pins = Pins(dut, random.Random(seed))
    await pins.start()
    return pins


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def records_are_where_the_pins_were(dut):
    pins = await begin(dut)
    await pins.set_filters((0, 1, 9, 15))
    for _ in range(300):
        if pins.rng.random() < 0.2:                                 # a glitch
            await pins.hold(1, pins.rng.randrange(1, MINIMUM))
            await pins.hold(0, pins.rng.randrange(1, 5))
        else:
            await pins.pulse()
    await pins.hold(0, 40)
    assert pins.seen == pins.wanted and len(pins.wanted) > 200


def times_alpha(x):
    """In the field of 16 elements, polynomial x^4 + x + 1."""
    return (x << 1 ^ (0b10011 if x & 8 else 0)) & 15


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def any_two_axes_show_one_sample_with_any_two_filters(dut):
    """Four axes at 256 quadruples of filters, in which any two axes meet in each of the 256 pairs: a line and its
    slopes in the plane over the field of 16 elements."""
    pins, met = await begin(dut), set()
    for a in range(FILTERS):
        for b in range(FILTERS):
            filters = a, b, a ^ b, a ^ times_alpha(b)
            met |= {(n, k, filters[n], filters[k]) for n in range(AXES) for k in range(n)}
            await pins.set_filters(filters)
            await pins.hold(0, pins.rng.randrange(20))
            await pins.pulse()
    await pins.hold(0, 40)
    assert pins.seen == pins.wanted
    assert len(pins.wanted) == FILTERS ** 2 and len(met) == 6 * FILTERS ** 2


def test_trigger(simulate):
    simulate(Bench(), tests="records")


def test_trigger_with_all_filters(simulate):
    simulate(Bench(), tests="any_two")
