# SPDX-License-Identifier: BSD-2-Clause
"""The scan line: from the steps of four axes to the SYNC, ENCODER and OUT0 pins, with no software in between."""

from amaranth import Array, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.compare import ComparePeripheral, CompareSettings, PositionCompare
from rtl.crossing import Handover, Latch
from rtl.divider import WIDTH_BITS, DividerPeripheral, DividerSettings, PixelDivider
from rtl.pulse import Pulse
from rtl.quadrature import StepStream
from rtl.router import PINS, ROUTER_LATENCY, PinRouter, RouterPeripheral, Routes

__all__ = ["AXES", "LINE_LATENCY", "LineCommand", "LinePeripheral", "LineReport", "ScanLine"]

AXES = 4

LINE_LATENCY = 7
"""``fast`` clocks from the clock that shows a step to the clock that shows it at a pin: 1 axis selector,
3 judgement, 1 pulse, 1 route, 1 pin.  The same for SYNC, pixel and direct, rising and falling."""


LineCommand = data.StructLayout({
    "arm": 1, "ticket": 1, "compare": CompareSettings, "axis": 2, "divider": DividerSettings,
})
"""``arm``: 1 arms, 0 disarms.  ``ticket``: comes back in the report once the command has had its effect."""

LiveSettings = data.StructLayout({"routes": Routes, "width": WIDTH_BITS, "axis": 2})
"""Settings that take effect without arming.  ``axis``: of the direct output."""

LineReport = data.StructLayout({
    "armed": 1, "active": 1, "late": 1, "ticket": 1, "started": 2, "finished": 2, "went_late": 2,
    "produced": 32, "end_position": 32, "merged": 32,
})
"""State of the line at one clock.  ``started``, ``finished`` and ``went_late`` count such events, modulo 4: no more
than 2 of a kind, one of each of two lines, come between two reports, since a command waits for a report."""


class AxisSelector(wiring.Component):
    """One of four step streams, from flip-flops: 1 ``fast`` clock after ``axis`` and the stream."""

    def __init__(self):
        super().__init__({**{f"step{n}": In(StepStream()) for n in range(AXES)}, "axis": In(2),
                          "step": Out(StepStream())})

    def elaborate(self, platform):
        m = Module()
        steps = [getattr(self, f"step{n}") for n in range(AXES)]
        for member in StepStream().members:
            m.d.fast += getattr(self.step, member).eq(Array(getattr(step, member) for step in steps)[self.axis])
        return m


class ScanLine(wiring.Component):
    """Selectors, compare, divider, pulse and router on one clock: all of the line that has edges in time.

    Domain ``fast``.  A step on ``stepN`` in clock 0 shows at the pins in clock 7 (:data:`LINE_LATENCY`): SYNC
    rises with the step that crosses the reference and falls with the one that completes the last pixel; a
    pulse rises with the step that completes its pixel; the direct output is channel A as of that step.

    SYNC and pixels may watch different axes: progress is counted on the divider's axis from the first clock
    after the one whose step fires SYNC.

    Members
    -------
    step0 to step3 : In(StepStream())
    command : In(LineCommand), command_stb : In(1)
        ``command_stb`` takes effect on the line at once; ``command`` is still until the next one.
    live : In(LiveSettings)
    light : In(1)
        One more source for the pins, from a flip-flop: shows 2 clocks later.
    report : Out(LineReport)
    out0, sync_out, encoder_out : Out(1)
        Pins, from flip-flops; 0 at reset.
    """

    def __init__(self):
        super().__init__({
            **{f"step{n}": In(StepStream()) for n in range(AXES)},
            "command": In(LineCommand), "command_stb": In(1), "live": In(LiveSettings), "light": In(1),
            "report": Out(LineReport),
            "out0": Out(1), "sync_out": Out(1), "encoder_out": Out(1),
        })

    def elaborate(self, platform):
        m = Module()
        m.submodules.compare_axis = compare_axis = AxisSelector()
        m.submodules.divider_axis = divider_axis = AxisSelector()
        m.submodules.compare = compare = PositionCompare()
        m.submodules.divider = divider = PixelDivider()
        m.submodules.pulse = pulse = Pulse(width=WIDTH_BITS)
        m.submodules.router = router = PinRouter()

        # Clock 0: axis.
        steps = [getattr(self, f"step{n}") for n in range(AXES)]
        for selector, axis in (compare_axis, self.command.compare.axis), (divider_axis, self.command.axis):
            m.d.comb += selector.axis.eq(axis)
            for n, step in enumerate(steps):
                connect(m, flipped(step), getattr(selector, f"step{n}"))

        # Clocks 1 to 3: judgement.
        arm = Signal()
        connect(m, compare.step, compare_axis.step)
        connect(m, divider.step, divider_axis.step)
        m.d.comb += [
            arm.eq(self.command_stb & self.command.arm),
            compare.settings.eq(self.command.compare), compare.arm.eq(arm),
            compare.disarm.eq(self.command_stb & ~self.command.arm), compare.done.eq(divider.done),
            divider.settings.eq(self.command.divider), divider.arm.eq(arm), divider.active.eq(compare.active),
        ]

        # Clock 4: pulse, and the levels of the same step.  A crossing shows in ``active`` a clock before a pixel
        # of the same step shows; ``active`` falls a clock after ``done``.
        armed, active = Signal(), Signal()          # a clock ago
        m.d.fast += [armed.eq(arm), active.eq(compare.active)]
        m.d.comb += [
            # The last pixel of the line before comes with ``armed`` at the latest, and is not counted in the new.
            pulse.trigger.eq(divider.pixel), pulse.width.eq(self.live.width), pulse.clear.eq(armed),
            router.pixel.eq(pulse.pulse),
        ]
        m.d.fast += router.sync.eq(compare.active & active & ~divider.done)
        direct = Signal(LINE_LATENCY - ROUTER_LATENCY)
        selected = Array(step.a for step in steps)[self.live.axis]
        m.d.fast += direct.eq((direct << 1) | selected)
        m.d.comb += router.direct.eq(direct[-1])

        # Clocks 5 and 6: pins.
        m.d.comb += [
            router.routes.eq(self.live.routes), router.light.eq(self.light),
            self.out0.eq(router.out0), self.sync_out.eq(router.sync_out), self.encoder_out.eq(router.encoder_out),
        ]

        report, late = self.report, Signal()
        m.d.fast += [
            late.eq(compare.late),
            report.started.eq(report.started + compare.fired),
            report.finished.eq(report.finished + divider.done),
            report.went_late.eq(report.went_late + (compare.late & ~late)),
        ]
        with m.If(compare.judged):
            m.d.fast += report.ticket.eq(self.command.ticket)
        m.d.comb += [
            report.armed.eq(compare.armed), report.active.eq(compare.active), report.late.eq(compare.late),
            report.produced.eq(divider.produced), report.end_position.eq(divider.end_position),
            report.merged.eq(pulse.merged),
        ]
        return m


class LinePeripheral(wiring.Component):
    """The scan line with its registers: three banks (compare, divider, router) and one interrupt.

    Registers in ``sync``, the line in ``fast``; all crossings are here.  A command takes its settings along, so
    a line is not disturbed by what is written for the next; ``Status.busy`` falls within 16 ``sync`` clocks of the
    write.  The report is fetched again and again: a register shows the line as it was at most 12 ``sync`` clocks
    ago, and an interrupt comes as late, with all results of the same clock.  Routes, width and the axis of the
    direct output are at work within 12 clocks of the write.

    Members
    -------
    compare_bus, divider_bus, router_bus : In(csr)
        See :class:`ComparePeripheral`, :class:`DividerPeripheral` and :class:`RouterPeripheral`.
    step0 to step3 : In(StepStream()), fast
    light : In(1), fast
        See :class:`ScanLine`.
    interrupt : Out(1)
        Level.
    out0, sync_out, encoder_out : Out(1), fast
        Pins, see :class:`ScanLine`.
    """

    def __init__(self):
        self._compare = ComparePeripheral()
        self._divider = DividerPeripheral()
        self._router = RouterPeripheral()
        super().__init__({
            "compare_bus": In(self._compare.bus.signature.flip()),
            "divider_bus": In(self._divider.bus.signature.flip()),
            "router_bus": In(self._router.bus.signature.flip()),
            **{f"step{n}": In(StepStream()) for n in range(AXES)},
            "light": In(1), "interrupt": Out(1), "out0": Out(1), "sync_out": Out(1), "encoder_out": Out(1),
        })
        for name in ("compare", "divider", "router"):
            getattr(self, f"{name}_bus").memory_map = getattr(self, f"_{name}").bus.memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.compare = compare = self._compare
        m.submodules.divider = divider = self._divider
        m.submodules.router = router = self._router
        m.submodules.line = line = ScanLine()
        for name in ("compare", "divider", "router"):
            connect(m, flipped(getattr(self, f"{name}_bus")), getattr(self, f"_{name}").bus)
        for n in range(AXES):
            connect(m, flipped(getattr(self, f"step{n}")), getattr(line, f"step{n}"))
        m.d.comb += [
            self.out0.eq(line.out0), self.sync_out.eq(line.sync_out), self.encoder_out.eq(line.encoder_out),
            line.light.eq(self.light), self.interrupt.eq(compare.interrupt), divider.arm.eq(compare.arm & ~compare.disarm),
        ]

        # Commands go one at a time; of those that wait, the last counts.  A refused arming only ends the line.
        m.submodules.command = command = Handover(LineCommand, source="sync", destination="fast")
        report = Signal(LineReport)
        waiting, arming, ticket = Signal(), Signal(), Signal()
        m.d.comb += command.request.eq(waiting & command.ready & (ticket == report.ticket))
        with m.If(command.request):
            m.d.sync += [waiting.eq(0), ticket.eq(~ticket)]
        with m.If(compare.arm | compare.disarm):
            m.d.sync += [waiting.eq(1), arming.eq(~compare.disarm & ~divider.refuses)]
        m.d.comb += [
            command.payload.arm.eq(arming), command.payload.ticket.eq(~ticket),
            command.payload.compare.eq(compare.settings), command.payload.axis.eq(divider.axis),
            command.payload.divider.eq(divider.settings),
            command.payload.divider.reverse.eq(compare.settings.reverse),
            line.command.eq(command.o), line.command_stb.eq(command.o_stb),
            # Busy at once, so that a read right behind the write cannot miss it.
            compare.busy.eq(compare.arm | compare.disarm | waiting | (ticket != report.ticket)),
        ]

        # Settings that need no arming follow their registers all the time.
        live_init = {"routes": {pin: {"source": source.value} for pin, source in PINS.items()}}
        m.submodules.live = live = Handover(LiveSettings, source="sync", destination="fast", init=live_init)
        m.d.comb += [
            live.request.eq(live.ready), line.live.eq(live.o),
            # No arming refuses a width written in a line: keep it from 0, of which Pulse makes 2**24.
            live.payload.routes.eq(router.routes), live.payload.width.eq(divider.width | (divider.width == 0)),
            live.payload.axis.eq(divider.axis),
        ]

        # So does the report; an event is a number that changed since the last one.
        m.submodules.latch = latch = Latch(LineReport, source="fast", reader="sync")
        m.d.comb += [latch.i.eq(line.report), latch.request.eq(~latch.busy)]
        with m.If(latch.done):
            m.d.sync += report.eq(latch.o)
        m.d.comb += [
            compare.started.eq(latch.done & (latch.o.started != report.started)),
            compare.finished.eq(latch.done & (latch.o.finished != report.finished)),
            compare.went_late.eq(latch.done & (latch.o.went_late != report.went_late)),
            compare.armed.eq(report.armed), compare.active.eq(report.active), compare.late.eq(report.late),
            divider.produced.eq(report.produced), divider.end_position.eq(report.end_position),
            divider.merged.eq(report.merged),
        ]
        return m
