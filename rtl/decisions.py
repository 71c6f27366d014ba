# SPDX-License-Identifier: BSD-2-Clause
"""From a TTL input to decisions in a register: short or long, pulse by pulse, in order, each once."""

from amaranth import Module, Mux, ResetInserter, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.classifier import BATCH, CLASSIFIER_LATENCY, ClassifierSettings, DecisionBatch, PulseClassifier
from rtl.crossing import Handover
from rtl.filter import GlitchFilter
from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["BATCHES", "ClassifierPeripheral", "DECISION_LATENCY", "DecisionQueue", "FILTER_BITS", "PulseInput"]

FILTER_BITS = 5

DECISION_LATENCY = 3 + CLASSIFIER_LATENCY
"""``fast`` clocks from the clock that samples the level that decides to the clock that shows the decision; a filter adds
its own.  2 synchroniser, of which the first samples; 1 filter; 2 classifier."""

BATCHES = 2048
"""Batches that wait for the processor: a block of RAM."""

LOST_MAX = 0xffff

PulseSettings = data.StructLayout({"pulse": ClassifierSettings, "filter": FILTER_BITS})


class PulseInput(wiring.Component):
    """Synchroniser, glitch filter and classifier of an input pin.

    Domain ``fast``.  A decision shows :data:`DECISION_LATENCY` clocks, and as many as the filter has samples, after the
    clock that samples the level that decides.

    Members
    -------
    pin : In(1)
        Asynchronous.
    settings : In(PulseSettings)
        ``filter``: samples, 0 is off.
    decided, long : Out(1)
        As of :class:`rtl.classifier.PulseClassifier`.
    """

    def __init__(self):
        super().__init__({"pin": In(1), "settings": In(PulseSettings), "decided": Out(1), "long": Out(1)})

    def elaborate(self, platform):
        m = Module()
        m.submodules.filter = level = GlitchFilter(bits=FILTER_BITS)
        m.submodules.classifier = classifier = PulseClassifier()
        m.submodules.sync = FFSynchronizer(self.pin, level.i, o_domain="fast")
        m.d.comb += [
            level.samples.eq(self.settings.filter), level.off.eq(self.settings.filter == 0),
            classifier.level.eq(level.level), classifier.settings.eq(self.settings.pulse),
            self.decided.eq(classifier.decided), self.long.eq(classifier.long),
        ]
        return m


class DecisionQueue(wiring.Component):
    """Decisions of ``fast`` wait for a reader in ``sync``, in order.

    They are gathered while those before them cross, which takes at most 23 clocks of ``fast``.  So a decision in every
    third clock is sustained, 66 million a second, as long as the queue is read; one alone can be read after at most 7
    ``sync`` edges.

    Parameters
    ----------
    batches : int
        Depth of the queue; at least 2.

    Members
    -------
    decided, long : In(1), fast
        A decision, in any clock.
    batch : Out(9), sync
        The oldest batch: a 1, and behind it, toward bit 0, its decisions in their order, 1 long, 0 short.  1 when none
        waits.
    take : In(1), sync
        Strobe: ``batch`` has been read; the next one shows in the next clock.
    clear : In(1), sync
        Strobe: forget all batches.
    level : Out(range(batches + 1)), sync
        Batches that wait.
    lost : Out(16), sync
        Decisions that found no room: in a batch, as of the last one that arrived, or in the queue.  Stays at 65535.
    """

    def __init__(self, *, batches=BATCHES):
        if not isinstance(batches, int) or batches < 2:
            raise ValueError(f"a queue holds at least 2 batches, not {batches!r}")
        self._batches = batches
        self._gather = DecisionBatch()
        self._handover = Handover(data.StructLayout({"batch": BATCH + 1, "lost": 16}), source="fast",
                                  destination="sync", init={"batch": 1})
        self._fifo = SyncFIFOBuffered(width=BATCH + 1, depth=batches)
        self._refused = Signal(16)          # decisions that found the queue full
        super().__init__({"decided": In(1), "long": In(1), "batch": Out(BATCH + 1), "take": In(1), "clear": In(1),
                          "level": Out(range(batches + 1)), "lost": Out(16)})

    def elaborate(self, platform):
        m = Module()
        m.submodules.gather = gather = self._gather
        m.submodules.handover = handover = self._handover
        m.submodules.fifo = ResetInserter({"sync": self.clear})(self._fifo)
        fifo, refused = self._fifo, self._refused

        leaves = Signal()
        m.d.comb += [
            gather.decided.eq(self.decided), gather.long.eq(self.long),
            leaves.eq(handover.ready & gather.waiting), gather.take.eq(leaves), handover.request.eq(leaves),
            handover.payload.batch.eq(gather.batch), handover.payload.lost.eq(gather.lost),
            fifo.w_data.eq(handover.o.batch), fifo.w_en.eq(handover.o_stb), fifo.r_en.eq(self.take),
            self.batch.eq(Mux(fifo.r_rdy, fifo.r_data, 1)), self.level.eq(fifo.level),
        ]

        # A batch of n decisions is at least 1 << n.
        count = sum(handover.o.batch[n:].any() for n in range(1, BATCH + 1))
        more, total = Signal(17), Signal(17)
        m.d.comb += [more.eq(refused + count), total.eq(refused + handover.o.lost)]
        with m.If(handover.o_stb & ~fifo.w_rdy):
            m.d.sync += refused.eq(Mux(more[16], LOST_MAX, more))
        m.d.sync += self.lost.eq(Mux(total[16], LOST_MAX, total))
        return m


class ClassifierPeripheral(wiring.Component):
    """Pulses at a TTL input, judged by their length, as decisions to read.

    Registers in ``sync``, the judgement in ``fast``.  A setting is at work within 7 ``sync`` clocks of its write.

    Members
    -------
    pin : In(1)
        Asynchronous.
    """

    class Threshold(Register, access="rw"):
        """From which length on a pulse is long.  Taken as a pulse begins."""
        value: Field(action.RW, unsigned(32), init=150_000, unit="fast clocks",
                     doc="A pulse of as many clocks is long, of one less short. 0 is 1.")

    class Config(Register, access="rw"):
        """How pulses are judged."""
        enable: Field(action.RW, 1, doc="Pulses that begin from now on are judged; 0 forgets the one under way.")
        at_threshold: Field(action.RW, 1, doc="The level at the threshold decides, high or low, and not before: rises "
                                              "until then are not seen. Otherwise a short pulse is judged as it ends.")
        filter: Field(action.RW, unsigned(FILTER_BITS), init=19, unit="fast clocks",
                      doc="Levels that last as long or less are not seen; 0 is off. Lengths of others are not changed.")

    class Decisions(Register, access="r"):
        """The oldest decisions.  Reading takes them: the next ones can be read 2 clocks later."""
        batch: Field(action.R, unsigned(BATCH + 1),
                     doc="The highest 1, and below it up to 8 decisions in their order: 1 long, 0 short. 1: there are "
                         "none.")

    class Status(Register, access="r"):
        """What waits to be read."""
        batches: Field(action.R, unsigned(BATCHES.bit_length()), doc=f"Batches in Decisions; {BATCHES} at most.")

    class Lost(Register, access="r"):
        """Decisions for which there was no room."""
        value: Field(action.R, unsigned(16), doc="Since reset. Stays at 65535.")

    class Control(Register, access="w"):
        """Forgets."""
        clear: Field(action.W, 1, doc="Write 1: decisions that wait are forgotten. Those of pulses that ended in the "
                                      "last 10 clocks come all the same.")

    def __init__(self):
        self._registers = registers = RegisterBank(addr_width=3)
        self._threshold = registers.add(self.Threshold, offset=0x00)
        self._config = registers.add(self.Config, offset=0x04)
        self._decisions = registers.add(self.Decisions, offset=0x08)
        self._status = registers.add(self.Status, offset=0x0c)
        self._lost = registers.add(self.Lost, offset=0x10)
        self._control = registers.add(self.Control, offset=0x14)
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "pin": In(1)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.input = pulses = PulseInput()
        m.submodules.queue = queue = DecisionQueue()
        connect(m, flipped(self.bus), self._registers.bus)

        threshold, config = self._threshold.f.value.data, self._config.f
        init = {"filter": self.Config.__annotations__["filter"].init,
                "pulse": {"threshold": self.Threshold.__annotations__["value"].init}}
        m.submodules.settings = settings = Handover(PulseSettings, source="sync", destination="fast", init=init)
        # The registers hold what was written one clock after the write strobe.
        m.d.sync += settings.request.eq(self._threshold.element.w_stb | self._config.element.w_stb)
        m.d.comb += [
            settings.payload.pulse.threshold.eq(threshold | (threshold == 0)),
            settings.payload.pulse.at_threshold.eq(config.at_threshold.data),
            settings.payload.pulse.enable.eq(config.enable.data), settings.payload.filter.eq(config.filter.data),
            pulses.settings.eq(settings.o), pulses.pin.eq(self.pin),
            queue.decided.eq(pulses.decided), queue.long.eq(pulses.long),
            queue.take.eq(self._decisions.f.batch.r_stb), self._decisions.f.batch.r_data.eq(queue.batch),
            self._status.f.batches.r_data.eq(queue.level), self._lost.f.value.r_data.eq(queue.lost),
            queue.clear.eq(self._control.f.clear.w_stb & self._control.f.clear.w_data),
        ]
        return m
