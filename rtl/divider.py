# SPDX-License-Identifier: BSD-2-Clause
"""Divide-by-N pixel clock: one pulse for every N edges of new progress along the active line."""

from amaranth import Cat, Module, Mux, Signal, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.countdown import Countdown
from rtl.quadrature import StepStream
from rtl.registers import Field, Register, RegisterBank, action, snake_case

__all__ = ["DividerPeripheral", "DividerSettings", "HighWater", "PixelDivider", "WIDTH_BITS"]

WIDTH = 32
WIDTH_BITS = 24
"""Bits of a pulse's width."""


DividerSettings = data.StructLayout({
    "reverse": 1, "whole": WIDTH, "fraction": WIDTH, "phase": WIDTH, "pixels": WIDTH, "emit": 1,
})
"""``reverse``: progress is toward lower counts.  N = ``whole`` + ``fraction`` * 2**-32, in edges, at least 1.
``phase``: phi * 2**32.  ``pixels``: pulses of a line, at least 1.  ``emit``: 0 counts pixels without pulses."""


class HighWater(wiring.Component):
    """Tell steps that break new ground from those that repeat it.

    Domain ``fast``; one step per clock.  ``front`` comes from a flip-flop and is true to every step up to the
    clock before, so ``forward & front & active`` is new progress.

    The distance behind the front is ``128 * high + 128 * spare + low``: the spare digit keeps carries and
    borrows of ``high`` at least 127 steps apart and away from zero, so ``high`` may follow and be compared
    clocks later, however the stage dithers.

    Members
    -------
    active : In(1)
        0 forgets the past: where the stage is becomes the front.
    forward, backward : In(1)
        Steps, not both.
    front : Out(1)
        Nothing of the way is repeated.  Wrong only after 2**32 steps behind the front.
    """

    def __init__(self):
        # State, for proofs.  ``carry``, ``borrow``: ``high`` changes a clock after ``low``.  ``near``: ``high``
        # was 0 one clock ago.
        self._low, self._spare, self._high = Signal(7), Signal(), Signal(25)
        self._carry, self._borrow, self._near = Signal(), Signal(), Signal(init=1)
        super().__init__({"active": In(1), "forward": In(1), "backward": In(1), "front": Out(1, init=1)})

    def elaborate(self, platform):
        m = Module()
        low, spare, high = self._low, self._spare, self._high
        carry, borrow, near = self._carry, self._borrow, self._near
        regain = self.forward & ~self.front
        m.d.fast += [
            near.eq(high == 0),
            carry.eq(self.active & self.backward & low.all() & spare),
            borrow.eq(self.active & regain & (low == 0) & ~spare),
        ]
        with m.If(~self.active):
            m.d.fast += [low.eq(0), spare.eq(0), self.front.eq(1)]
        with m.Elif(self.backward):
            m.d.fast += [low.eq(low + 1), spare.eq(spare | low.all()), self.front.eq(0)]
        with m.Elif(regain):
            m.d.fast += [low.eq(low - 1), spare.eq(spare & (low != 0)),
                         self.front.eq(near & ~spare & (low == 1))]
        with m.If(~self.active):
            m.d.fast += high.eq(0)
        with m.Elif(carry | borrow):
            m.d.fast += high.eq(high + Mux(borrow, -1, 1))
        return m


class PixelDivider(wiring.Component):
    """Pixel k at the edge that brings progress to floor(k * N + phi), k = 1 to ``pixels``.

    Domain ``fast``.  A step on ``step`` in clock 0 gives ``pixel`` in clock 3, at one step and one pixel per
    clock.  Progress is the number of edges newly crossed in the scan direction while ``active``: a step that is
    in clock 1 (see above) when ``active`` first shows is the first to count.  Ground that is lost is not counted
    again when it is regained.

    The recurrence S <- S + N, S = phi at first, in whole and fraction: the edges to the next pixel are ``whole``,
    and one more when the fraction carries.

    Members
    -------
    step : In(StepStream())
        Steps of the axis that counts.
    settings : In(DividerSettings)
        Held still from the clock of ``arm`` until the next ``arm``.
    arm : In(1)
        Strobe: a new line; the results go to 0.  ``active`` may follow from the 4th clock on, and so may the
        next ``arm``.  A pixel of the line before comes in the clock after ``arm`` at the latest.
    active : In(1)
        Gate.  Falling, it ends the line; the results stay once a step of the clock before is judged.  Falls in the
        clock after ``done`` at the latest, and with ``arm``.
    pixel : Out(1)
        One-clock strobe: a pixel is complete, and a pulse wanted (``settings.emit``).
    done : Out(1)
        One-clock strobe with the last pixel, also when no pulse is wanted.
    produced : Out(32)
        Pixels completed, with or without a pulse.  One clock after ``pixel``.
    end_position : Out(signed(32))
        ``step.count`` at the last of them, 0 before the first.  With ``produced``.
    """

    def __init__(self):
        # State, for proofs; see elaborate().
        self._edges, self._pixels = Countdown(width=WIDTH), Countdown(width=WIDTH)
        self._high_water = HighWater()
        self._primed, self._fraction = Signal(4, name="primed"), Signal(WIDTH, name="fraction")
        self._progress, self._addend = Signal(name="progress"), Signal(WIDTH, name="addend")
        self._carry, self._after, self._extra, self._advance = Signal(), Signal(), Signal(), Signal()
        super().__init__({
            "step": In(StepStream(WIDTH)), "settings": In(DividerSettings), "arm": In(1), "active": In(1),
            "pixel": Out(1), "done": Out(1), "produced": Out(WIDTH), "end_position": Out(signed(WIDTH)),
        })

    def elaborate(self, platform):
        m = Module()
        m.submodules.edges = edges = self._edges
        m.submodules.pixels = pixels = self._pixels
        m.submodules.high_water = high_water = self._high_water

        # Clock 0: the step in terms of the scan.
        forward, backward = Signal(), Signal()
        count = Signal(signed(WIDTH))
        m.d.fast += [
            forward.eq(self.step.moved & (self.step.up ^ self.settings.reverse)),
            backward.eq(self.step.moved & ~(self.step.up ^ self.settings.reverse)),
            count.eq(self.step.count),
        ]

        # Clock 1: progress.
        progress = self._progress
        m.d.comb += [
            high_water.active.eq(self.active),
            high_water.forward.eq(forward), high_water.backward.eq(backward),
        ]
        m.d.fast += progress.eq(forward & high_water.front & self.active & ~self.arm)

        # Clock 2: whether it completes a pixel.  After the last pixel nothing is reloaded, so that no other
        # follows before ``active`` falls.
        complete, extra = Signal(), self._extra
        primed = self._primed                       # 1 to 4 clocks after ``arm``
        m.d.comb += [
            complete.eq(progress & edges.last),
            edges.value.eq(self.settings.whole), edges.extra.eq(extra),
            edges.load.eq(primed[3]), edges.reload.eq(~pixels.last), edges.step.eq(progress),
            pixels.value.eq(self.settings.pixels), pixels.load.eq(primed[2]), pixels.step.eq(complete),
        ]
        m.d.fast += [
            primed.eq(Cat(self.arm, primed)),
            self.pixel.eq(complete & self.settings.emit), self.done.eq(complete & pixels.last),
        ]

        # The fraction works ahead and a clock behind the pixels: ``extra`` is the carry for the next reload,
        # ``after`` the one for the reload after it unless ``carry`` is just about to move there.
        fraction, carry, after, advance = self._fraction, self._carry, self._after, self._advance
        following, priming, completed = Signal(), Signal(), Signal()
        m.d.fast += [priming.eq(self.arm | primed.any()), completed.eq(complete), after.eq(following)]
        m.d.comb += [
            # Joined behind the flip-flops: ``complete`` comes late in its clock.
            advance.eq(priming | completed), following.eq(Mux(advance, carry, after)),
        ]
        with m.If(primed[2:].any() | complete):
            m.d.fast += extra.eq(following)
        # It begins at 0, and the first that is added is the phase: so nothing stands behind the adder.
        addend = self._addend
        m.d.fast += addend.eq(Mux(self.arm, self.settings.phase, self.settings.fraction))
        with m.If(self.arm):
            m.d.fast += fraction.eq(0)
        with m.Elif(advance):
            m.d.fast += Cat(fraction, carry).eq(fraction + addend)

        # Clock 3: results.
        progress_count, pixel_count = Signal(signed(WIDTH)), Signal(signed(WIDTH))
        m.d.fast += [progress_count.eq(count), pixel_count.eq(progress_count)]
        with m.If(primed[0]):
            m.d.fast += [self.produced.eq(0), self.end_position.eq(0)]
        with m.Elif(completed):
            m.d.fast += [self.produced.eq(self.produced + 1), self.end_position.eq(pixel_count)]
        return m


class DividerPeripheral(wiring.Component):
    """Registers of the pixel clock: its divisor, its pulses, and what a line produced.  Domain ``sync``.

    Members
    -------
    bus : In(csr)
    axis : Out(2)
        Axis that counts.
    settings : Out(DividerSettings)
        All but ``reverse``.
    width : Out(24)
        Of a pulse, in ``fast`` clocks.
    refuses : Out(1)
        Level: with the settings as they are a line must not be armed.
    arm : In(1)
        Strobe: an arming is requested; ``Status.refused`` takes ``refuses``.
    produced, end_position, merged : In
        Results for the registers of these names.
    """

    class Axis(Register, access="rw"):
        """Axis whose edges are counted (ENCODER)."""
        value: Field(action.RW, 2, doc="0 X, 1 Y, 2 Z, 3 F. Taken at arming; the direct output follows at once.")

    class Whole(Register, access="rw"):
        """Whole part of N, the edges from one pixel to the next.  Taken at arming."""
        value: Field(action.RW, WIDTH, unit="edges", doc="0 is refused.")

    class Fraction(Register, access="rw"):
        """Fraction of N.  Taken at arming."""
        value: Field(action.RW, WIDTH, unit="2^-32 edges", doc="Pixel k comes at floor(k * N + phi) edges.")

    class Phase(Register, access="rw"):
        """phi, what the fraction begins with.  Taken at arming."""
        value: Field(action.RW, WIDTH, init=0xffffffff, unit="2^-32 edges",
                     doc="0 rounds the place of each pixel down, 0xffffffff up, 0x80000000 to the nearest.")

    class Pixels(Register, access="rw"):
        """Pixels of a line; the last one ends it.  Taken at arming."""
        value: Field(action.RW, WIDTH, doc="0 is refused.")

    class Width(Register, access="rw"):
        """Length of a pulse."""
        value: Field(action.RW, WIDTH_BITS, unit="fast clocks",
                     doc="Taken at the next pulse. 0 is refused at arming, and written in a line acts as 1.")

    class IntervalMin(Register, access="rw"):
        """Time between two pixels at the highest speed the line is scanned at; used to judge Width only."""
        value: Field(action.RW, WIDTH, unit="fast clocks", doc="Less than Width + 2 is refused at arming.")

    class Config(Register, access="rw"):
        """What pixels do.  Taken at arming."""
        emit: Field(action.RW, 1, doc="Pixels give pulses; otherwise they are counted only, and end the line.")

    class Status(Register, access="r"):
        """How the last arming and its line went."""
        refused: Field(action.R, 1, doc="The last arming was refused for Whole, Pixels, Width or IntervalMin; "
                                        "nothing is armed.")
        merged: Field(action.R, 1, doc="Merged is not 0.")

    class Produced(Register, access="r"):
        """Pixels of the line so far; live, at most 240 ns old, and final with the event finished."""
        value: Field(action.R, WIDTH, doc="Counted with or without a pulse. To 0 at arming.")

    class EndPosition(Register, access="r"):
        """Position at the last pixel that Produced counts."""
        value: Field(action.R, signed(WIDTH), unit="counts",
                     doc="Just after its edge, on the axis of the divider. To 0 at arming.")

    class Merged(Register, access="r"):
        """Pulses of the line that came while the last was still high, and so lengthened it."""
        value: Field(action.R, WIDTH, doc="To 0 at arming.")

    def __init__(self):
        self._registers = RegisterBank(addr_width=4)
        for n, register in enumerate((self.Axis, self.Whole, self.Fraction, self.Phase, self.Pixels, self.Width,
                                      self.IntervalMin, self.Config, self.Status, self.Produced,
                                      self.EndPosition, self.Merged)):
            setattr(self, f"_{snake_case(register.__name__)}", self._registers.add(register, offset=4 * n))
        memory_map = self._registers.finish()
        super().__init__({
            "bus": In(self._registers.bus_signature), "axis": Out(2), "settings": Out(DividerSettings),
            "width": Out(WIDTH_BITS), "refuses": Out(1), "arm": In(1),
            "produced": In(WIDTH), "end_position": In(signed(WIDTH)), "merged": In(WIDTH),
        })
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        connect(m, flipped(self.bus), self._registers.bus)
        for name in ("whole", "fraction", "phase", "pixels"):
            m.d.comb += getattr(self.settings, name).eq(getattr(self, f"_{name}").f.value.data)
        whole, pixels, width = self.settings.whole, self.settings.pixels, self._width.f.value.data
        m.d.comb += [
            self.axis.eq(self._axis.f.value.data),
            self.settings.emit.eq(self._config.f.emit.data),
            self.width.eq(width),
            self.refuses.eq((whole == 0) | (pixels == 0) | (width == 0) |
                            (width + 2 > self._interval_min.f.value.data)),
        ]

        refused = Signal()
        with m.If(self.arm):
            m.d.sync += refused.eq(self.refuses)
        m.d.comb += [
            self._status.f.refused.r_data.eq(refused),
            self._status.f.merged.r_data.eq(self.merged != 0),
            self._produced.f.value.r_data.eq(self.produced),
            self._end_position.f.value.r_data.eq(self.end_position),
            self._merged.f.value.r_data.eq(self.merged),
        ]
        return m
