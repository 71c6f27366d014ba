# SPDX-License-Identifier: BSD-2-Clause
"""rtl/line.py over its bus, with real decoders and encoder edges at any time: every pin edge, to the picosecond."""

import random

import cocotb
from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge, Timer, ValueChange
from cocotb.utils import get_sim_time

from rtl.line import AXES, LINE_LATENCY, LinePeripheral
from rtl.quadrature import DECODER_LATENCY, QuadratureDecoder
from tb.models.line import Line, Step, expect, pulses

LATENCY = DECODER_LATENCY + LINE_LATENCY        # 10 fast clocks from the clock that samples a pin to the pin
FAST_PS = 5000
BANKS = ("compare", "divider", "router")


class DecodersAndLine(wiring.Component):
    """Four decoders before a scan line, for a test from pin to pin."""

    def __init__(self):
        self._line = LinePeripheral()
        buses = {f"{bank}_bus": In(getattr(self._line, f"{bank}_bus").signature.flip()) for bank in BANKS}
        super().__init__({**buses, "a": In(AXES), "b": In(AXES), "interrupt": Out(1),
                          "out0": Out(1), "sync_out": Out(1), "encoder_out": Out(1)})
        for bus in buses:
            getattr(self, bus).memory_map = getattr(self._line, bus).memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.line = line = self._line
        for bank in BANKS:
            connect(m, flipped(getattr(self, f"{bank}_bus")), getattr(line, f"{bank}_bus"))
        for axis in range(AXES):
            m.submodules[f"decoder{axis}"] = decoder = QuadratureDecoder()
            connect(m, decoder.steps, getattr(line, f"step{axis}"))
            m.d.comb += [decoder.a.eq(self.a[axis]), decoder.b.eq(self.b[axis])]
        for pin in ("interrupt", "out0", "sync_out", "encoder_out"):
            m.d.comb += getattr(self, pin).eq(getattr(line, pin))
        return m


REGISTERS = {f"{bank}.{'_'.join(info.path[0])}": (bank, info.start)
             for bank in BANKS
             for info in getattr(LinePeripheral(), f"{bank}_bus").memory_map.all_resources()}


def now():
    """Picoseconds."""
    return int(get_sim_time("ps"))


class Controller:
    """The registers by name, the encoders by position, and a record of the pins."""

    def __init__(self, dut, seed=0):
        self.dut, self.random = dut, random.Random(seed)
        self.position, self.steps, self.edges = [0] * AXES, [], {"sync_out": [], "encoder_out": [], "out0": []}

    async def start(self):
        dut = self.dut
        # Sync and fast drift against each other by a few ps: no test may lean on their phase.
        Clock(dut.clk, 19998, unit="ps").start()
        Clock(dut.fast_clk, FAST_PS, unit="ps").start()
        for bank in BANKS:
            for name in ("addr", "r_stb", "w_stb", "w_data"):
                getattr(dut, f"{bank}_bus__{name}").value = 0
        dut.a.value = dut.b.value = 0
        dut.rst.value = dut.fast_rst.value = 1
        await Timer(100, unit="ns")
        dut.rst.value = dut.fast_rst.value = 0
        await Timer(1000, unit="ns")
        await RisingEdge(dut.fast_clk)
        self.origin = now()
        for pin in self.edges:
            cocotb.start_soon(self._record(pin))

    def sampled_at(self, time):
        """Time of the first rising edge of fast after ``time``; one at the same time comes too early."""
        return time + FAST_PS - (time - self.origin) % FAST_PS

    async def _record(self, pin):
        handle = getattr(self.dut, pin)
        while True:
            await ValueChange(handle)
            self.edges[pin].append((now(), int(handle.value)))

    def _port(self, name, port):
        bank, offset = REGISTERS[name]
        return getattr(self.dut, f"{bank}_bus__{port}"), offset

    async def write(self, name, value):
        for port, bits in (("addr", None), ("w_data", value % 2**32), ("w_stb", 1)):
            handle, offset = self._port(name, port)
            handle.value = offset if bits is None else bits
        await RisingEdge(self.dut.clk)
        self._port(name, "w_stb")[0].value = 0
        await RisingEdge(self.dut.clk)
        await RisingEdge(self.dut.clk)

    async def read(self, name):
        for port, bits in (("addr", None), ("r_stb", 1)):
            handle, offset = self._port(name, port)
            handle.value = offset if bits is None else bits
        await RisingEdge(self.dut.clk)
        self._port(name, "r_stb")[0].value = 0
        await RisingEdge(self.dut.clk)
        return self._port(name, "r_data")[0].value.to_unsigned()

    async def settle(self):
        """Wait until ``Status.busy`` is 0."""
        for _ in range(60):
            if not await self.read("compare.status") & 8:
                return
        raise AssertionError("busy for 60 reads")

    async def set_line(self, line, *, width=2, interval=1000, emit=1):
        for name, value in (("compare.config", line.axis | line.reverse << 2), ("compare.reference", line.reference),
                            ("divider.axis", line.pixel_axis), ("divider.whole", line.whole),
                            ("divider.fraction", line.fraction), ("divider.phase", line.phase),
                            ("divider.pixels", line.pixels), ("divider.width", width),
                            ("divider.interval_min", interval), ("divider.config", emit)):
            await self.write(name, value)

    async def arm(self):
        await self.write("compare.control", 1)
        await self.settle()
        return await self.read("compare.status")

    async def move(self, axis, count, *, fastest_ps=10100, slowest_ps=60000):
        """Move an axis to a count, edge by edge, each at a random picosecond."""
        while self.position[axis] != count:
            direction = 1 if count > self.position[axis] else -1
            await Timer(self.random.randrange(fastest_ps, slowest_ps), unit="ps")
            self.position[axis] += direction
            quarter = self.position[axis] % 4
            bit = 1 << axis
            for handle, level in ((self.dut.a, quarter in (1, 2)), (self.dut.b, quarter in (2, 3))):
                handle.value = int(handle.value) & ~bit | (bit if level else 0)
            self.steps.append(Step(self.sampled_at(now()), axis, direction))
            await Timer(100, unit="ps")

    def since(self, pin, start):
        return [(time, level) for time, level in self.edges[pin] if time >= start]


async def check(control, line, start, since, *, width=2, slack=0):
    """Every edge at SYNC and ENCODER since ``since`` is where the model says, LATENCY clocks after its sample."""
    await Timer(2, unit="us")
    steps = [step for step in control.steps if step.time >= since]
    expected = expect(line, steps, start=start, armed=since)
    want_sync = [(t, level) for t, level in ((expected.rise, 1), (expected.fall, 0)) if t is not None]
    clocks = [(t - control.origin) // FAST_PS for t in expected.pixels]
    want_pixels = [(control.origin + (clock - 1) * FAST_PS, level)
                   for pulse in pulses(clocks, width)[0] for clock, level in zip(pulse, (1, 0))]
    for pin, want in (("sync_out", want_sync), ("encoder_out", want_pixels)):
        got = control.since(pin, since)
        assert [level for _, level in got] == [level for _, level in want], \
            f"{pin}: {len(got)} edges instead of {len(want)}"
        for (time, _), (sampled, _) in zip(got, want):
            late = time - sampled - LATENCY * FAST_PS
            assert 0 <= late <= slack * FAST_PS and late % FAST_PS == 0, \
                f"{pin} {(time - sampled) / FAST_PS} clocks after the sample, not {LATENCY}"
    return expected


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(n=[1, 24, 24.4, 38, 454], reverse=[False, True])
async def every_pin_edge_comes_ten_clocks_after_its_sample(dut, n, reverse):
    control = Controller(dut, seed=int(n * 10) + reverse)
    await control.start()
    sign = -1 if reverse else 1
    pixels = min(40, 1200 // int(n))
    whole, fraction = divmod(round(n * 2**32), 2**32)
    line = Line(reference=5 * sign, reverse=reverse, whole=whole, fraction=fraction, pixels=pixels)
    width = 1 if n == 1 else 2                      # edges may be 2 clocks apart
    await control.set_line(line, width=width)
    since = now()
    assert await control.arm() == 1
    for target in (7, 3, 8, 5 + pixels * (whole + 1) // 2, 5 + pixels * (whole + 1) // 3, 10 + pixels * (whole + 1)):
        await control.move(0, target * sign)
    expected = await check(control, line, {0: 0}, since, width=width)
    assert len(expected.pixels) == pixels
    assert await control.read("compare.interrupt") == 0b011
    assert dut.interrupt.value == 1
    await control.write("compare.interrupt", 0b011)
    assert dut.interrupt.value == 0
    assert await control.read("compare.status") == 0
    assert await control.read("divider.produced") == pixels
    assert await control.read("divider.end_position") == expected.end_position % 2**32
    assert await control.read("divider.merged") == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_line_may_watch_two_axes(dut):
    control = Controller(dut, seed=3)
    await control.start()
    line = Line(reference=10, axis=1, pixel_axis=2, whole=3, pixels=6)
    await control.set_line(line)
    since = now()
    await control.arm()
    paths = [cocotb.start_soon(control.move(1, 30)), cocotb.start_soon(control.move(2, 50))]
    for path in paths:
        await path
    expected = await check(control, line, {1: 0, 2: 0}, since)
    assert len(expected.pixels) == 6
    assert await control.read("divider.end_position") == expected.end_position


@cocotb.test(timeout_time=5, timeout_unit="ms")
@cocotb.parametrize(bad=[("whole", 0), ("pixels", 0), ("width", 0), ("interval_min", 6), ("width", 2**24 - 1)])
async def a_line_that_cannot_work_is_refused(dut, bad):
    control = Controller(dut)
    await control.start()
    line = Line(reference=2, whole=3, pixels=2)
    await control.set_line(line, width=5, interval=7)
    assert await control.arm() == 1                 # 2 clocks low are enough
    name, value = bad
    await control.write(f"divider.{name}", value)
    assert await control.arm() == 0                 # and what was armed before is not any more
    assert await control.read("divider.status") & 1 == 1
    await control.move(0, 12)
    await Timer(1, unit="us")
    assert control.edges["sync_out"] == control.edges["encoder_out"] == []
    await control.set_line(Line(reference=20, whole=3, pixels=2), width=5, interval=7)
    assert await control.arm() == 1
    assert await control.read("divider.status") & 1 == 0


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def late_is_reported_and_interrupts(dut):
    control = Controller(dut)
    await control.start()
    await control.move(0, 5)
    await control.set_line(Line(reference=5, whole=3, pixels=2))
    assert await control.arm() == 4
    assert await control.read("compare.interrupt") == 0b100
    await control.move(0, 3)
    await control.move(0, 15)
    await Timer(1, unit="us")
    assert control.edges["sync_out"] == []


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def disarming_ends_a_line_and_keeps_its_results(dut):
    control = Controller(dut)
    await control.start()
    await control.set_line(Line(reference=2, whole=2, pixels=10))
    await control.arm()
    await control.move(0, 7)
    await Timer(1, unit="us")
    assert await control.read("compare.status") == 2
    assert await control.read("divider.produced") == 2      # live, in the middle of the line
    await control.write("compare.control", 2)
    await control.settle()
    assert await control.read("compare.status") == 0
    assert dut.sync_out.value == 0
    await control.move(0, 30)
    assert await control.read("divider.produced") == 2
    assert await control.read("divider.end_position") == 6
    assert await control.read("compare.interrupt") == 1     # started, never finished


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def an_event_interrupts_within_half_a_microsecond_of_its_pin(dut):
    control = Controller(dut, seed=4)
    await control.start()
    for turn in range(20):
        await control.set_line(Line(reference=control.position[0] + 2, whole=3, pixels=1))
        await control.arm()
        mover = cocotb.start_soon(control.move(0, control.position[0] + 2))
        for pin, event in (dut.sync_out, 1), (dut.encoder_out, 2):
            await RisingEdge(pin)
            at_pin = now()
            await RisingEdge(dut.interrupt)
            assert now() - at_pin <= 500_000
            assert await control.read("compare.interrupt") == event
            assert await control.read("divider.produced") == event - 1
            await control.write("compare.interrupt", event)
            if event == 1:
                await mover
                mover = cocotb.start_soon(control.move(0, control.position[0] + 4))
        await mover


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def settings_written_during_a_line_wait_for_the_next(dut):
    control = Controller(dut)
    await control.start()
    line = Line(reference=3, whole=2, pixels=8)
    await control.set_line(line)
    since = now()
    await control.arm()
    await control.move(0, 7)
    await control.set_line(Line(reference=50, reverse=True, whole=9, pixels=1, axis=3, pixel_axis=2))
    await control.move(0, 30)
    await check(control, line, {0: 0}, since)
    line = Line(reference=15, reverse=True, whole=4, pixels=3)
    await control.set_line(line)
    since = now()
    assert await control.arm() == 1
    assert await control.read("divider.produced") == 0
    await control.move(0, -5)
    expected = await check(control, line, {0: 30}, since)
    assert await control.read("divider.end_position") == expected.end_position == 2


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def writes_while_busy_are_not_lost(dut):
    control = Controller(dut)
    await control.start()
    await control.set_line(Line(reference=3, whole=2, pixels=8))
    for value, status in ((1, 1), (2, 0), (1, 1), (3, 0)):
        for earlier in (1, 2, 1):
            await control.write("compare.control", earlier)
        await control.write("compare.control", value)
        await control.settle()
        assert await control.read("compare.status") == status


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def merged_pulses_are_counted_and_the_pin_stays_high(dut):
    control = Controller(dut)
    await control.start()
    line = Line(reference=2, whole=1, pixels=5)
    await control.set_line(line, width=400, interval=402)
    since = now()
    await control.arm()
    await control.move(0, 9)
    await Timer(4, unit="us")
    await check(control, line, {0: 0}, since, width=400)
    assert await control.read("divider.merged") == 4
    assert await control.read("divider.status") == 2


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def a_width_of_0_written_in_a_line_is_1_and_not_84_ms(dut):
    control = Controller(dut)
    await control.start()
    line = Line(reference=2, whole=3, pixels=5)
    await control.set_line(line)
    since = now()
    assert await control.arm() == 1
    await control.write("divider.width", 0)
    await Timer(1, unit="us")
    await control.move(0, 30)
    await check(control, line, {0: 0}, since, width=1)
    assert await control.read("divider.merged") == 0
    await control.write("compare.control", 1)
    await control.settle()
    assert await control.read("divider.status") & 1         # refused, as ever


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def routes_and_polarity_apply_to_pins(dut):
    control = Controller(dut)
    await control.start()
    await control.write("router.out0", 1)
    await Timer(1, unit="us")
    assert dut.out0.value == 1
    await control.write("router.out0", 4)                   # direct: channel A of the divider's axis
    await control.write("divider.axis", 3)
    await Timer(1, unit="us")
    control.edges["out0"].clear()
    control.steps.clear()
    await control.move(3, 40)
    await Timer(1, unit="us")
    want = [step.time + LATENCY * FAST_PS for n, step in enumerate(control.steps, 1) if n % 2]
    assert [time for time, _ in control.edges["out0"]] == want
    await control.write("router.sync", 2 | 16)
    await Timer(1, unit="us")
    assert control.edges["sync_out"][-1][1] == 1 and len(control.edges["sync_out"]) == 1


@cocotb.test(timeout_time=5, timeout_unit="ms")
async def late_synchronisers_cost_a_clock_at_most(dut):
    # For random_delay only: pins may be sampled a clock later, and nothing else changes.
    control = Controller(dut, seed=9)
    await control.start()
    line = Line(reference=5, whole=4, fraction=2**30, pixels=60)
    for turn in range(3):
        await control.set_line(line)
        since, start = now(), control.position[0]
        assert await control.arm() == 1
        await control.move(0, 300, fastest_ps=20200)
        await check(control, line, {0: start}, since, width=2, slack=1)
        assert await control.read("compare.interrupt") == 0b011
        await control.write("compare.interrupt", 0b111)
        assert await control.read("divider.produced") == 60
        await control.move(0, 0, fastest_ps=20200)


def test_pin_to_pin(simulate):
    simulate(DecodersAndLine(), tests="^(?!.*late_synchronisers)")


def test_with_random_delays(simulate):
    simulate(DecodersAndLine(), random_delay=True, tests="late_synchronisers|disarming|refused|busy|late_is")
