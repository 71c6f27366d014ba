# SPDX-License-Identifier: BSD-2-Clause
"""The crossings lose and invent nothing, for every interleaving of the two clocks and every late synchroniser.

Both clocks are free: in each step of the solver either, both or neither ticks, so no ratio, phase or drift is
assumed, and a clock may pause for ever.  Inputs change at any step.
"""

from amaranth import Cat, Mux, Signal

from tb.formal.proof import AnySeq, Assert, Cover, Proof, two_clocks


def counter(m, limit, *, clear, tick):
    """Ticks since ``clear``, up to ``limit``; a tick in the step of ``clear`` is not after it."""
    ticks = Signal(range(limit + 1), init=limit)
    with m.If(clear):
        m.d.formal += ticks.eq(0)
    with m.Elif(tick & (ticks < limit)):
        m.d.formal += ticks.eq(ticks + 1)
    return ticks


class Strobes:
    """An account of a StrobeCrossing: what was given, what is under way, and for how long.

    ``waiting``: a strobe was given and has not left.  ``flying``: one left and has not arrived.
    ``there_ticks`` of the destination since it left, ``back_ticks`` of the source since it arrived.
    """

    def __init__(self, m, dut, *, tick, tock):
        self.waiting, self.flying = Signal(), Signal()
        self.leaves, self.arrives = tick & dut.sent, tock & dut.o
        self.there_ticks = counter(m, 5, clear=self.leaves, tick=tock)
        self.back_ticks = counter(m, 3, clear=self.arrives, tick=tick)
        with m.If(tick):
            m.d.formal += self.waiting.eq(Mux(dut.sent, self.waiting & dut.i, self.waiting | dut.i))
        with m.If(self.leaves != self.arrives):
            m.d.formal += self.flying.eq(self.leaves)

    def lemmas(self, dut, synchronisers):
        """A change travels the ring of flip-flops alone, and is not slower or faster than they are."""
        (request, *there), (answer, *back) = synchronisers
        there, flying = [*there, dut._seen], self.flying
        ring = [request, *there, answer, *back]
        changes = Cat(x ^ y for x, y in zip(ring, ring[1:]))
        return [
            (changes & (changes - 1)) == 0,
            dut.o == (dut._seen ^ answer), flying == (request ^ answer), dut._kept == self.waiting,
            # The first flip-flop may be skipped (it is there for lateness only), the others not.
            *(~flying | (self.there_ticks < n) | (flop == request) for n, flop in enumerate(there, 1)),
            *(~flying | (self.there_ticks >= max(n, 1)) | (flop != request) for n, flop in enumerate(there)),
            *(flying | (self.back_ticks < n) | (flop == answer) for n, flop in enumerate(back, 1)),
            *(flying | (self.back_ticks >= max(n, 1)) | (flop != answer) | (changes == 0)
              for n, flop in enumerate(back)),
        ]


class StrobesAllArrive(Proof):
    """Every strobe given leaves, each that leaves arrives once, none else arrives, and all in time."""

    block = "rtl.crossing"
    depth = 3
    cover_depth = bug_depth = 16
    widths = "two free clocks, synchronisers late or not"
    bugs = {
        "a strobe while busy is dropped": ("(~idle & (kept | self.i))", "(~idle & kept)"),
        "a strobe as the kept one leaves is dropped": ("(idle & kept & self.i) | ", ""),
        "a strobe leaves while one is under way": ("self.sent.eq(idle & (", "self.sent.eq(("),
        "the answer leaves a clock too early": ("answer.eq(seen)", "answer.eq(arrived)"),
        "ready though a strobe is kept": ("self.ready.eq(idle & ~kept)", "self.ready.eq(idle)"),
        "the level is taken for its change": ("self.o.eq(arrived ^ seen)", "self.o.eq(arrived | seen)"),
    }

    def harness(self, m, block):
        tick, tock = Signal(), Signal()
        dut = block.StrobeCrossing(source="sync", destination="fast")
        m.submodules.dut, synchronisers = two_clocks(dut, sync=tick, fast=tock)
        m.d.comb += [tick.eq(AnySeq(1)), tock.eq(AnySeq(1)), dut.i.eq(AnySeq(1))]
        account = Strobes(m, dut, tick=tick, tock=tock)
        m.d.comb += self.lemmas(*account.lemmas(dut, synchronisers))

        m.d.comb += [
            # Nothing is invented: what leaves was given, what arrives had left, and only one is under way.
            Assert(~dut.sent | dut.i | account.waiting),
            Assert(~dut.o | account.flying), Assert(~dut.sent | ~account.flying),
            # Nothing is lost: it arrives in time, and what waits leaves in time.
            Assert(~account.flying | (account.there_ticks < 4) | dut.o),
            Assert(account.flying | (account.back_ticks < 3) | dut.ready | dut.sent),
            # ``ready`` means what it says, and the latencies are those of the docstring.
            Assert(~dut.ready | ~account.waiting & ~account.flying),
            Assert(~dut.o | (account.there_ticks == 3) | (account.there_ticks == 4)),
            Assert(~(dut.ready | dut.sent) | (account.back_ticks >= 2)),
        ]

        given, arrived = Signal(4), Signal(4)
        m.d.formal += [given.eq(given + (tick & dut.i)), arrived.eq(arrived + account.arrives)]
        m.d.comb += [
            Cover((given == 2) & (arrived == 2) & dut.ready), Cover((given == 4) & (arrived == 1)),
        ]


class SettingsArriveWhole(Proof):
    """What is handed over arrives whole and in order; when ``ready``, the last requested payload has arrived."""

    block = "rtl.crossing"
    depth = 3
    cover_depth = bug_depth = 18
    widths = "payload 32, two free clocks, synchronisers late or not"
    bugs = {
        "the copy is made at the request": ("hold.take.eq(crossing.sent)", "hold.take.eq(self.request)"),
        "the copy is taken without its strobe": ("with m.If(crossing.o):", "with m.If(~crossing.o):"),
        "a request while busy is dropped": ("(~idle & (kept | self.i))", "(~idle & kept)"),
        "the answer leaves before the copy is taken": ("answer.eq(seen)", "answer.eq(arrived)"),
    }

    def harness(self, m, block):
        tick, tock = Signal(), Signal()
        dut = block.Handover(32, source="sync", destination="fast")
        m.submodules.dut, synchronisers = two_clocks(dut, sync=tick, fast=tock)
        m.d.comb += [
            tick.eq(AnySeq(1)), tock.eq(AnySeq(1)),
            dut.request.eq(AnySeq(1)), dut.payload.eq(AnySeq(32)),
        ]
        account = Strobes(m, dut._crossing, tick=tick, tock=tock)

        # The payload as it was when the request left; and what has arrived of it.
        sent, arrived, new = Signal(32), Signal(32), Signal()
        with m.If(account.leaves):
            m.d.formal += sent.eq(dut.payload)
        with m.If(account.arrives):
            m.d.formal += arrived.eq(sent)
        with m.If(tock):
            m.d.formal += new.eq(account.arrives)
        m.d.comb += [
            Assert(dut.o == arrived), Assert(dut.o_stb == new),
            Assert(~dut.ready | (dut.o == sent) & ~account.waiting & ~account.flying),
            *self.lemmas(*account.lemmas(dut._crossing, synchronisers), dut._hold.o == sent,
                         account.flying | (sent == arrived)),
            Cover(dut.ready & (arrived == 0x12345678)), Cover((arrived == 7) & (sent == 9) & account.waiting),
        ]


class ResultsAreStill(Proof):
    """What is latched is one instant of the other domain, after every request, and still until the next."""

    block = "rtl.crossing"
    depth = 3
    cover_depth = bug_depth = 18
    widths = "value 32, two free clocks, synchronisers late or not"
    bugs = {
        "done before it is latched": ("answer.eq(seen)", "answer.eq(request)"),
        "done though a request is kept": ("self.ready.eq(idle & ~kept)", "self.ready.eq(idle)"),
        "the value follows": ("with m.If(self.take):", "with m.If(self.take | ~self.take):"),
        "a request while busy is dropped": ("(~idle & (kept | self.i))", "(~idle & kept)"),
        "done comes twice": ("self.done.eq(self._was_busy & ~self.busy)", "self.done.eq(~self.busy)"),
    }

    def harness(self, m, block):
        tick, tock = Signal(), Signal()
        dut = block.Latch(32, source="fast", reader="sync")
        m.submodules.dut, synchronisers = two_clocks(dut, sync=tick, fast=tock)
        m.d.comb += [tick.eq(AnySeq(1)), tock.eq(AnySeq(1)), dut.request.eq(AnySeq(1)), dut.i.eq(AnySeq(32))]
        account = Strobes(m, dut._crossing, tick=tick, tock=tock)

        # ``owed``: nothing was latched since the last request; ``awaited``: it has no ``done`` yet.
        latched, owed, awaited = Signal(32), Signal(), Signal()
        with m.If(tock & dut.capture):
            m.d.formal += [latched.eq(dut.i), owed.eq(0)]
        with m.If(tick & dut.done):
            m.d.formal += awaited.eq(0)
        with m.If(tick & dut.request):
            m.d.formal += [owed.eq(1), awaited.eq(1)]
        m.d.comb += [
            Assert(dut.o == latched),
            Assert(dut.busy | ~owed & ~dut.capture),
            Assert(dut.done == (awaited & ~dut.busy)),
            *self.lemmas(*account.lemmas(dut._crossing, synchronisers),
                         ~owed | account.waiting | account.flying,
                         awaited | ~dut.busy, dut._was_busy | dut.busy | ~awaited),
            Cover(dut.done & (latched == 0x12345678)), Cover(account.waiting & (latched == 7)),
        ]
