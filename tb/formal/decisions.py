# SPDX-License-Identifier: BSD-2-Clause
"""Decisions that cross from ``fast`` to ``sync``: each one once, in its place, for every interleaving of the clocks.

The queue behind it is Amaranth's; what is claimed is what goes into it.  :mod:`tb.formal.classifier` proves what gathers
them, and counts those that find no room there.
"""

from amaranth import Mux, Signal

from tb.formal.crossing import Strobes
from tb.formal.proof import AnyConst, AnySeq, Assert, Cover, Proof, two_clocks

BATCH = 8


def length(batch):
    """Decisions of a batch: the place of its highest 1."""
    return sum(batch[n:].any() for n in range(1, BATCH + 1))


class DecisionsCrossInOrder(Proof):
    """Any decisions at any time: what is put into the queue is every decision that was gathered, in order; when nothing
    is under way, all of them.  What the full queue refuses is counted, decision by decision."""

    block = "rtl.decisions"
    depth = 4
    cover_depth = 24
    bug_depth = 16
    widths = "batch 8, lost 16, two free clocks, synchronisers late or not"
    bugs = {
        "a batch leaves while one is under way": ("handover.ready & gather.waiting", "gather.waiting"),
        "a batch of none leaves": ("handover.ready & gather.waiting", "handover.ready"),
        "a batch is forgotten that does not leave": ("gather.take.eq(leaves)", "gather.take.eq(gather.waiting)"),
        "a batch is put twice": ("fifo.w_en.eq(handover.o_stb)", "fifo.w_en.eq(1)"),
        "those that find room are counted as lost": ("handover.o_stb & ~fifo.w_rdy", "handover.o_stb & fifo.w_rdy"),
    }

    def harness(self, m, block):
        tick, tock = Signal(), Signal()         # of `fast` and of `sync`
        dut = block.DecisionQueue(batches=2)
        m.submodules.dut, synchronisers = two_clocks(dut, fast=tick, sync=tock)
        m.d.comb += [tick.eq(AnySeq(1)), tock.eq(AnySeq(1)), dut.decided.eq(AnySeq(1)), dut.long.eq(AnySeq(1)),
                     dut.take.eq(AnySeq(1)), dut.clear.eq(AnySeq(1))]
        gather, handover, fifo = dut._gather, dut._handover, dut._fifo
        account = Strobes(m, handover._crossing, tick=tick, tock=tock)

        # How many decisions so far were gathered, have left, have arrived, were put: modulo 2**8, and one of them, any.
        gathered, left, arrived, put = (Signal(8, name=n) for n in ("gathered", "left", "arrived", "put"))
        tracked, long = AnyConst(8), Signal()
        waiting = Signal(4)
        m.d.comb += waiting.eq(gathered - left)
        with m.If(tick & dut.decided & (account.leaves | (waiting != BATCH))):
            m.d.formal += gathered.eq(gathered + 1)
            with m.If(gathered == tracked):
                m.d.formal += long.eq(dut.long)
        with m.If(account.leaves):
            m.d.formal += left.eq(gathered)
        with m.If(account.arrives):
            m.d.formal += arrived.eq(left)
        puts, n = Signal(), length(fifo.w_data)
        m.d.comb += puts.eq(tock & fifo.w_en)
        with m.If(puts):
            m.d.formal += put.eq((put + n)[:8])

        def has(batch, newest, oldest):
            """If the one tracked is among those after ``oldest`` up to ``newest``, this batch of them has it right."""
            place = (newest - 1 - tracked)[:8]
            return (place >= (newest - oldest)[:8]) | (batch.bit_select(place[:4], 1) == long)

        def counts(batch, newest, oldest):
            return (length(batch) == (newest - oldest)[:8]) & batch.any()

        refused, found = Signal(17), Signal(17)
        m.d.comb += found.eq(refused + handover.o.lost)
        with m.If(puts & ~fifo.w_rdy):
            m.d.formal += refused.eq(Mux(refused + n > 0xffff, 0xffff, refused + n))
        lost = Signal(16)
        with m.If(tock):
            m.d.formal += lost.eq(Mux(found > 0xffff, 0xffff, found))

        under_way = account.flying | handover.o_stb | (waiting != 0)
        m.d.comb += [
            Assert(~fifo.w_en | (n != 0)),
            Assert(~fifo.w_en | has(fifo.w_data, (put + n)[:8], put)),
            Assert(under_way | (put == gathered)), Assert(dut.lost == lost),
            Assert(dut.batch == Mux(fifo.r_rdy, fifo.r_data, 1)),
            *self.lemmas(
                *account.lemmas(handover._crossing, synchronisers), ~account.waiting,
                (gathered - left)[:8] <= BATCH, (left - arrived)[:8] <= BATCH, (arrived - put)[:8] <= BATCH,
                counts(gather.batch, gathered, left), gather.waiting == (waiting != 0), has(gather.batch, gathered, left),
                # The copy is still while it flies, and what has arrived of it until it is put.
                account.flying == (left != arrived), handover.o_stb == (arrived != put),
                ~account.flying | counts(handover._hold.o.batch, left, arrived),
                ~account.flying | has(handover._hold.o.batch, left, arrived),
                ~handover.o_stb | counts(handover.o.batch, arrived, put),
                ~handover.o_stb | has(handover.o.batch, arrived, put),
                dut._refused == refused, refused <= 0xffff),
            Cover((put == 5) & (gathered == 7) & account.flying), Cover(refused == 3),
        ]
