# SPDX-License-Identifier: BSD-2-Clause
"""The flash's frames: nothing that could harm the bitstreams leaves the pins, whatever is written to the registers and when."""

from amaranth import Cat, Mux, Signal

from tb.formal.proof import AnySeq, Assert, Assume, Cover, Proof, one_clock

HARMLESS = (0x03, 0x05, 0x06, 0x9f, 0xab)       # read, status, write enable, identification, wake
PROGRAM, ERASE = 0x02, 0x20
FIRST = 0x40_0000


class NothingBelowTheGuardIsChanged(Proof):
    """Any starts, opcodes, addresses, words and aborts in any clock: a flash at the pins sees no opcode but the seven that are
    known, and none that programs or erases with an address below the guard. It looks at pins alone, as a flash does: bits at
    rising edges of sck while it is selected."""

    block = "rtl.flash"
    depth = 4
    cover_depth = 20
    bug_depth = 52
    widths = "address 24, words 32, guard 0x400000"
    bugs = {
        "the guard is a sector too low": ("self.address[12:] < self._guard >> 12", "self.address[12:] < (self._guard >> 12) - 1"),
        "an erase is not guarded": ("CHANGING = (Opcode.PAGE_PROGRAM, Opcode.SECTOR_ERASE)", "CHANGING = (Opcode.PAGE_PROGRAM,)"),
        "the address is taken when it is sent": ("header.bit_select(~index, 1)", "Cat(self.address, header[24:]).bit_select(~index, 1)"),
        "any opcode leaves": ("with m.If(known & ~guarded):", "with m.If(~guarded):"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.FlashFrames(guard=FIRST), "sync")
        for name in ("start", "opcode", "address", "size", "abort", "take", "put", "put_word", "miso"):
            port = getattr(dut, name)
            m.d.comb += port.eq(AnySeq(len(port)))
        if not self._with_lemmas:               # one frame is enough for a bug, and many take the solver long
            begun = Signal()
            m.d.formal += begun.eq(1)
            m.d.comb += Assume(~begun | ~(dut.start | dut.abort))

        # What the flash has received since it was selected: the opcode and the two highest bits of an address, which say whether it
        # is below 0x400000.
        seen, count, sck = Signal(10, name="seen"), Signal(range(11), name="count"), Signal(name="before")
        rises = dut.sck & ~sck & ~dut.cs_n
        m.d.formal += sck.eq(dut.sck)
        with m.If(dut.cs_n):
            m.d.formal += [seen.eq(0), count.eq(0)]
        with m.Elif(rises & (count != 10)):
            m.d.formal += [seen.eq(Cat(dut.mosi, seen)), count.eq(count + 1)]

        opcode, missing, beyond = Signal(8), Signal(6), Signal(2)       # bits to 32; bits behind the opcode
        m.d.comb += [missing.eq(32 - count), beyond.eq(Mux(count < 8, 0, count - 8)), opcode.eq(seen >> beyond)]
        changes = (opcode == PROGRAM) | (opcode == ERASE)
        m.d.comb += [
            Assert((count < 8) | changes | Cat(opcode == code for code in HARMLESS).any()),
            Assert((count < 10) | ~changes | (seen[:2] != 0)),
        ]

        # What induction needs to know of the inside: what the flash has seen is the beginning of the header.
        header, index, phase, addressed = dut._header, dut._index, dut._phase, dut._addressed
        select, in_header, between, data, end = dut._state
        code, under_way = header[24:], dut._state.any()
        m.d.comb += self.lemmas(
            ~dut.busy | Cat(code == c for c in (*HARMLESS, PROGRAM, ERASE)).any(),
            ~dut.busy | ~((code == PROGRAM) | (code == ERASE)) | (header[:24] >= FIRST),
            ~dut.busy | (addressed == Cat(code == c for c in (0x03, PROGRAM, ERASE)).any()),
            under_way | dut.cs_n, dut.busy | (count == 0), ~(between | data | in_header) | ~dut.cs_n,
            ~(end & dut.cs_n) | (count == 0), ~(dut.busy & ~under_way) | (index == 0) | (count == 0),
            ~select | ((count == 0) & (index == 0)), count <= 10, (count != 0) | (seen == 0),
            ~in_header | (count == Mux(index < 10, index, 10)), ~in_header | (phase == 0) | (dut.mosi == header.bit_select(~index, 1)),
            ~in_header | (dut.sck == ((phase == 3) | ((phase == 0) & (index != 0)))),
            ~in_header | (sck == ((phase[1] == 0) & (index != 0))), under_way & ~select & ~end | ~dut.sck,
            ~(between | data) | (count >= Mux(addressed, 10, 8)),
            ~dut.busy | (count == 0) | Mux(addressed | (count <= 8), seen == header >> missing, opcode == code),
        )
        m.d.comb += [
            Cover((count == 2) & (code == ERASE) & in_header), Cover(end & (count == 1)), Cover(dut.refused & (dut.opcode == PROGRAM)),
        ]
