# SPDX-License-Identifier: BSD-2-Clause
"""A trigger freezes the position of all axes: no matter how they are filtered, as of one sample of the pins."""

from amaranth import Array, Cat, Module, Mux, Shape, Signal, Value, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.crossing import Handover, Hold, StrobeCrossing
from rtl.quadrature import FILTER_BITS
from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["MINIMUM", "MINIMUM_BITS", "RECORDS", "RecordQueue", "TriggerCapture", "TriggerPeripheral",
           "TriggerSettings", "record_layout"]

AXES = 4

MINIMUM_BITS = 8

MINIMUM = 2 + (1 << FILTER_BITS)
"""Shortest pulse in ``fast`` clocks: by then the axis with the longest filter has shown where it was at the trigger."""

RECORDS = 1024
"""Records that wait for the processor, at most."""

MISSED_BITS = 32


TriggerSettings = data.StructLayout({"minimum": MINIMUM_BITS, "enable": 1})
"""``minimum``: clocks that a pulse must last, and the pause after it; at least :data:`MINIMUM`."""

InputSettings = data.StructLayout({"trigger": TriggerSettings, "output": 1, "falling": 1})
"""``output``: 1 watches OUT0, 0 IN0.  ``falling``: 1 inverts it first."""


def record_layout(axes, width):
    """A record: the time and the counts, all of one sample of the pins."""
    return data.StructLayout({"moment": 64, "counts": data.ArrayLayout(signed(width), axes)})


class TriggerCapture(wiring.Component):
    """Latch the counts of all axes as they were when the trigger rose, and say so once it has proven a pulse.

    Domain ``fast``.  ``level`` and the encoders' pins pass like synchronisers.  A count is taken as many clocks later
    as its axis needs to show the sample in which the level rose: 2, and its filter's.  So all counts of a record are
    those of that one sample, whatever the filters, and none of them waits for ``minimum``.

    A rise that does not last for ``minimum`` clocks is a glitch: no record, no pause.  After a pulse the level must be
    low for ``minimum`` clocks without a break before the next rise is one.  So records are at least twice ``minimum``
    apart.

    Parameters
    ----------
    axes, width : int
        Number of counts, and bits of each.

    Members
    -------
    level : In(1)
        The pin, behind a synchroniser of two flip-flops.
    settings : In(TriggerSettings)
        ``minimum`` is taken as a pulse or a pause begins.  Disabled, no pulse begins.
    filter : In(4).array(axes)
        That the decoders use; the one in use as the level rises counts.  An edge less than 16 clocks after the trigger
        may be in the record if the filter became shorter meanwhile.
    count : In(signed(width)).array(axes)
        Of the decoders.
    time : In(64)
    record : Out(1)
        One-clock strobe, in the clock after the pulse's clock number ``minimum``: ``o`` is that of a pulse, until the
        next rise.
    o : Out(record_layout(axes, width))
        ``moment`` is ``time`` in the clock after the first that shows the level: 3 more than in the clock whose end
        sampled the pin.
    """

    def __init__(self, *, axes=AXES, width=32):
        self._axes = axes
        # State, for proofs.  ``was``: the level a clock ago.  ``idle``: a rise begins a pulse.  ``pulse``: it has to
        # last for ``left`` more clocks.  Neither: a pause has to.
        self._was, self._idle, self._pulse, self._last = Signal(init=1), Signal(), Signal(), Signal()
        self._left = Signal(MINIMUM_BITS, init=MINIMUM)
        self._filters = [Signal(FILTER_BITS, name=f"filter{n}") for n in range(axes)]     # as of the last rise
        super().__init__({
            "level": In(1), "settings": In(TriggerSettings), "filter": In(FILTER_BITS).array(axes),
            "count": In(signed(width)).array(axes), "time": In(64),
            "record": Out(1), "o": Out(record_layout(axes, width)),
        })

    def elaborate(self, platform):
        m = Module()
        idle, pulse, left, minimum = self._idle, self._pulse, self._left, self.settings.minimum
        m.d.fast += [self._was.eq(self.level), self.record.eq(0)]
        # What is left is reckoned where nobody looks, while idle and behind a broken pulse, so that it need not know.
        rise, last = Signal(), self._last
        m.d.comb += rise.eq(idle & self.level & ~self._was & self.settings.enable)
        m.d.fast += last.eq((left == 2) & ~idle & (pulse | ~self.level))
        with m.If(idle):
            m.d.fast += left.eq(minimum - 1)
        with m.Elif(Mux(pulse, last, self.level)):
            m.d.fast += left.eq(minimum)
        with m.Else():
            m.d.fast += left.eq(left - 1)

        with m.If(pulse):
            m.d.fast += [pulse.eq(self.level & ~last), idle.eq(~self.level), self.record.eq(self.level & last)]
        with m.Elif(rise):
            m.d.fast += [idle.eq(0), pulse.eq(1)]
        with m.Elif(~idle):
            m.d.fast += idle.eq(~self.level & last)

        # A glitch's strobes are still on their way as the next pulse begins; those of the pulse come last.
        age = Signal(1 << FILTER_BITS)              # bit k: a pulse began k + 1 clocks ago
        m.d.fast += age.eq(Cat(rise, age))
        with m.If(age[0]):
            m.d.fast += self.o.moment.eq(self.time)
        for n, chosen in enumerate(self._filters):
            with m.If(rise):
                m.d.fast += chosen.eq(self.filter[n])
            take = Signal(name=f"take{n}")
            m.d.fast += take.eq(Array(age)[chosen])
            with m.If(take):
                m.d.fast += self.o.counts[n].eq(self.count[n])
        return m


class RecordQueue(wiring.Component):
    """Records on their way from ``fast``, and those that wait in ``sync``.

    A record given in clock 0 waits as of the 4th ``sync`` edge after it (5th when late), and can be read one clock
    later.  Records may follow each other by twice :data:`MINIMUM` ``fast`` clocks; the crossing takes 24 at most.

    Parameters
    ----------
    shape : shape-like
        Of a record.
    depth : int
        Records that can wait.

    Members
    -------
    given : In(1), i : In(shape), fast
        Strobe: ``i`` is a record.
    take : In(1), sync
        Strobe: the oldest record gives way to the next.
    level : Out, sync
        Records that wait.
    o : Out(shape), sync
        The oldest; without meaning when there is none.
    missed : Out(32), sync
        Records that came while ``depth`` waited, and are lost.  Stays at its last value.
    """

    def __init__(self, shape, *, depth=RECORDS):
        self._crossing = StrobeCrossing(source="fast", destination="sync")
        self._hold = Hold(shape, domain="fast")
        self._fifo = SyncFIFOBuffered(width=Shape.cast(shape).width, depth=depth)
        super().__init__({
            "given": In(1), "i": In(shape), "take": In(1), "level": Out(range(depth + 1)), "o": Out(shape),
            "missed": Out(MISSED_BITS),
        })

    def elaborate(self, platform):
        m = Module()
        m.submodules.crossing = crossing = self._crossing
        m.submodules.hold = hold = self._hold
        m.submodules.fifo = fifo = self._fifo
        m.d.comb += [
            crossing.i.eq(self.given), hold.i.eq(self.i), hold.take.eq(crossing.sent),
            fifo.w_data.eq(hold.o), fifo.w_en.eq(crossing.o),
            fifo.r_en.eq(self.take), self.level.eq(fifo.level), self.o.eq(fifo.r_data),
        ]
        with m.If(crossing.o & ~fifo.w_rdy & ~self.missed.all()):
            m.d.sync += self.missed.eq(self.missed + 1)
        return m


class TriggerPeripheral(wiring.Component):
    """The trigger on the register bus.  Registers are the nested classes, in address order.

    Registers in ``sync``, the trigger in ``fast``.  ``interrupt`` is high while a record waits, if enabled.

    Parameters
    ----------
    axes : int
        1 to 4; otherwise :exc:`ValueError`.  Counts of axes beyond read 0.

    Members
    -------
    in0 : In(1)
        Pin, asynchronous.
    out0 : In(1), fast
        Pin, from its flip-flop.  Passes two flip-flops, as a wire from this pin to IN0 would.
    filter, count : In(4).array(axes), In(signed(32)).array(axes), fast
        Of the decoders.
    time : In(64), fast
        Of the snapshot.
    """

    class Config(Register, access="rw"):
        """What makes a record.  Taken over within 6 ``sync`` clocks of the write; no pulse begins in the clock in
        which it is."""
        enable: Field(action.RW, 1, doc="Pulses make records. A pulse that has begun makes its record in any case.")
        output: Field(action.RW, 1, doc="1 watches pin OUT0 as it is driven, 0 pin IN0.")
        falling: Field(action.RW, 1, doc="1: a pulse is low and begins with a falling edge.")
        minimum: Field(action.RW, MINIMUM_BITS, init=MINIMUM, unit="fast clocks",
                       doc="A pulse is one when it has lasted so long, and so has the pause before the next. Below 18 acts "
                           "as 18.")

    class InterruptEnable(Register, access="rw"):
        """Conditions that hold the interrupt line."""
        waiting: Field(action.RW, 1, doc="Interrupt while Level is not 0.")

    class Level(Register, access="r"):
        """The queue."""
        records: Field(action.R, unsigned(11), unit="records", doc="Records that wait, at most 1024.")

    class Missed(Register, access="r"):
        """Records that found the queue full."""
        records: Field(action.R, MISSED_BITS, unit="records", doc="Lost since reset. Stays at 4294967295.")

    class Next(Register, access="w"):
        """Taking records."""
        take: Field(action.W, 1, doc="Write 1: the record that the registers below show is done with, and they show the "
                                     "next.")

    class TimeLow(Register, access="r"):
        """Time of the oldest record, low word.  Without meaning while Level is 0, as the registers behind it."""
        value: Field(action.R, 32, unit="fast clocks", doc="Bits 0 to 31 of the time of the pulse's first edge: as a "
                                                           "snapshot would have stamped the same positions.")

    class TimeHigh(Register, access="r"):
        """Time of the oldest record, high word."""
        value: Field(action.R, 32, unit="fast clocks", doc="Bits 32 to 63.")

    class Count(Register, access="r"):
        """Position of one axis in the oldest record."""
        value: Field(action.R, signed(32), unit="counts", doc="When the pins were sampled that showed the pulse's first "
                                                              "edge; of all axes the same sample.")

    def __init__(self, *, axes=AXES, depth=RECORDS):
        if not isinstance(axes, int) or not 1 <= axes <= AXES:
            raise ValueError(f"a trigger has 1 to {AXES} axes, not {axes!r}")
        self._axes, self._depth = axes, depth
        self._registers = registers = RegisterBank(addr_width=4)
        self._config = registers.add(self.Config, offset=0x00)
        self._enable = registers.add(self.InterruptEnable, offset=0x04)
        self._level = registers.add(self.Level, offset=0x08)
        self._missed = registers.add(self.Missed, offset=0x0c)
        self._next = registers.add(self.Next, offset=0x10)
        self._record = [
            registers.add(self.TimeLow, offset=0x14), registers.add(self.TimeHigh, offset=0x18),
            *(registers.add(self.Count, offset=0x1c + 4 * n, name=f"count{n}") for n in range(AXES)),
        ]
        memory_map = registers.finish()
        super().__init__({
            "bus": In(registers.bus_signature), "interrupt": Out(1), "in0": In(1), "out0": In(1),
            "filter": In(FILTER_BITS).array(axes), "count": In(signed(32)).array(axes), "time": In(64),
        })
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.capture = capture = TriggerCapture(axes=self._axes)
        m.submodules.queue = queue = RecordQueue(record_layout(self._axes, 32), depth=self._depth)
        connect(m, flipped(self.bus), self._registers.bus)

        # The register holds what was written one clock after the write strobe.
        config = self._config.f
        m.submodules.settings = settings = Handover(InputSettings, source="sync", destination="fast",
                                                    init={"trigger": {"minimum": MINIMUM}})
        minimum = config.minimum.data
        m.d.sync += settings.request.eq(self._config.element.w_stb)
        m.d.comb += [
            settings.payload.trigger.minimum.eq(Mux(minimum < MINIMUM, MINIMUM, minimum)),
            settings.payload.trigger.enable.eq(config.enable.data),
            settings.payload.output.eq(config.output.data), settings.payload.falling.eq(config.falling.data),
        ]

        in0, out0 = Signal(), Signal(2)
        m.submodules.in0_sync = FFSynchronizer(self.in0, in0, o_domain="fast")
        m.d.fast += out0.eq(Cat(self.out0, out0))
        m.d.comb += [
            # Another pin or polarity is no edge.
            capture.level.eq(Mux(settings.o.output, out0[1], in0) ^ settings.o.falling),
            capture.settings.minimum.eq(settings.o.trigger.minimum),
            capture.settings.enable.eq(settings.o.trigger.enable & ~settings.o_stb),
            capture.time.eq(self.time), queue.given.eq(capture.record), queue.i.eq(capture.o),
        ]
        for n in range(self._axes):
            m.d.comb += [capture.filter[n].eq(self.filter[n]), capture.count[n].eq(self.count[n])]

        take, words = self._next.f.take, Value.cast(queue.o)
        for n, register in enumerate(self._record[:2 + self._axes]):
            m.d.comb += register.f.value.r_data.eq(words.word_select(n, 32))
        m.d.comb += [
            queue.take.eq(take.w_stb & take.w_data),
            self._level.f.records.r_data.eq(queue.level), self._missed.f.records.r_data.eq(queue.missed),
            self.interrupt.eq(self._enable.f.waiting.data & (queue.level != 0)),
        ]
        return m
