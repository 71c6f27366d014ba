# SPDX-License-Identifier: BSD-2-Clause
"""Drive :class:`rtl.line.ScanLine` clock by clock, record its pins, and compare both with tables and the model."""

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

from rtl.line import LINE_LATENCY, LineCommand, LineReport, LiveSettings
from tb.models.line import Step, expect, pulses

PINS = {"sync": "sync_out", "encoder": "encoder_out", "out0": "out0"}


def command(*, arm, reference=0, reverse=0, whole=1, fraction=0, phase=0xffffffff, pixels=1, emit=1, axis=0,
            pixel_axis=0, **_):
    """Bits of a :class:`LineCommand`; reference and counts modulo 2**32."""
    signed = (reference + 2**31) % 2**32 - 2**31
    return LineCommand.const({
        "arm": arm, "ticket": 0, "axis": pixel_axis,
        "compare": {"axis": axis, "reverse": reverse, "reference": signed},
        "divider": {"reverse": reverse, "whole": whole, "fraction": fraction, "phase": phase, "pixels": pixels,
                    "emit": emit},
    }).as_bits()


def live(routes, *, width=1, pixel_axis=0, **_):
    """Bits of the :class:`LiveSettings`; ``routes`` as in the scenario tables."""
    pins = {pin: {"source": routes[name], "invert": routes[f"{name}_invert"]} for name, pin in PINS.items()}
    return LiveSettings.const({"routes": pins, "width": width, "axis": pixel_axis}).as_bits()


class Bench:
    """One clock at a time: inputs and outputs of clock n are those between its rising edge and the next."""

    def __init__(self, dut, position):
        self.dut, self.position, self.clock = dut, [position.get(n, 0) for n in range(4)], 0

    async def start(self, live_bits):
        dut = self.dut
        Clock(dut.fast_clk, 5, unit="ns").start()
        dut.command.value = dut.command_stb.value = 0
        dut.live.value = live_bits
        self._drive({})
        for reset in (1, 1, 0, 0, 0, 0, 0, 0, 0):
            dut.fast_rst.value = reset
            await FallingEdge(dut.fast_clk)

    def _drive(self, moves):
        for axis in range(4):
            step = moves.get(axis, 0)
            self.position[axis] += step
            port = lambda name: getattr(self.dut, f"step{axis}__{name}")
            port("moved").value, port("up").value = int(step != 0), int(step > 0)
            port("count").value = self.position[axis] % 2**32
            port("a").value = int(self.position[axis] % 4 in (1, 2))

    async def tick(self, moves=None, command_bits=None, live_bits=None):
        """One clock; ``moves``: {axis: +1 or -1}.  Returns what pins and report show in it."""
        self._drive(moves or {})
        self.dut.command_stb.value = int(command_bits is not None)
        if command_bits is not None:
            self.dut.command.value = command_bits
        if live_bits is not None:
            self.dut.live.value = live_bits
        seen = {name: int(getattr(self.dut, pin).value) for name, pin in PINS.items()}
        seen["report"] = int(self.dut.report.value)
        await FallingEdge(self.dut.fast_clk)
        self.clock += 1
        return seen


def report_fields(bits):
    const = LineReport.from_bits(bits)
    signed = (const.end_position + 2**31) % 2**32 - 2**31
    return {"armed": const.armed, "late": const.late, "active": const.active, "produced": const.produced,
            "end_position": signed, "merged": const.merged}


async def play(dut, scenario):
    """Check every clock of a scenario of ``tb/vectors``."""
    setup, routes = scenario.setup, dict(scenario.routes)
    bench = Bench(dut, {0: setup["start"], 1: setup["start_y"]})
    await bench.start(live(routes, **setup))
    for clock in range(scenario.clocks):
        given = scenario.inputs.get(clock, {})
        routes.update({key: value for key, value in given.items() if key in routes})
        strobe = command(arm=int("arm" in given), **setup) if {"arm", "disarm"} & given.keys() else None
        moves = {axis: given[f"step{axis}"] for axis in (0, 1) if f"step{axis}" in given}
        seen = await bench.tick(moves, strobe, live(routes, **setup))
        seen.update(report_fields(seen.pop("report")))
        for name, values in scenario.outputs.items():
            assert seen[name] == values[clock], \
                f"{scenario.name}: {name} is {seen[name]}, not {values[clock]}, in clock {clock}"


def model_of(scenario):
    """``{"sync": [...], "encoder": [...]}`` by clock, from the model, for one arming and default routes."""
    setup = scenario.setup
    steps = [Step(clock, axis, given[f"step{axis}"]) for clock, given in scenario.inputs.items()
             for axis in (0, 1) if f"step{axis}" in given]
    armed = next(clock for clock, given in scenario.inputs.items() if "arm" in given)
    line = to_line(setup)
    expected = expect(line, steps, start={0: setup["start"], 1: setup["start_y"]}, armed=armed)
    levels = {"sync": [0] * scenario.clocks, "encoder": [0] * scenario.clocks}
    end = scenario.clocks
    if expected.rise is not None:
        fill(levels["sync"], expected.rise + LINE_LATENCY,
             end if expected.fall is None else expected.fall + LINE_LATENCY)
    for rise, fall in pulses(expected.pixels if setup["emit"] else [], setup["width"])[0]:
        fill(levels["encoder"], rise + LINE_LATENCY - 1, fall + LINE_LATENCY - 1)
    return levels


def to_line(setup):
    from tb.models.line import Line
    names = ("reference", "reverse", "whole", "fraction", "phase", "pixels", "axis", "pixel_axis")
    return Line(**{name: setup[name] for name in names if name in setup})


def fill(levels, start, stop):
    levels[start:stop] = [1] * len(levels[start:stop])
