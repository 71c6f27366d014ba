# SPDX-License-Identifier: BSD-2-Clause
"""The flash's frames: nothing that could harm the bitstreams leaves the pins, whatever is written to the registers and when."""

from amaranth import Cat, Mux, Signal

from tb.formal.proof import AnySeq, Assert, Cover, Proof, one_clock

HARMLESS = (0x03, 0x05, 0x06, 0x9f, 0xab)       # read, status, write enable, identification, wake
PROGRAM, ERASE = 0x02, 0x20
LOWEST, LOCKED, JUMP = 0x3fe, 0x400, 0xfff      # sectors of 4 KiB


class NothingGuardedIsChanged(Proof):
    """Any starts, opcodes, addresses, words, aborts and locks in any clock: a flash at the pins sees no opcode but the seven that
    are known, and none that programs or erases with an address below 0x3fe000, or below 0x400000 once the lock has been given, or
    in the last sector. It looks at pins alone, as a flash does: bits at rising edges of sck while it is selected."""

    block = "rtl.flash"
    depth = 4
    cover_depth = 32
    bug_depth = 93
    widths = "address 24, words 32"
    bugs = {
        "the bitstreams end a sector too low": ("LOWEST = 0x3f_e000", "LOWEST = 0x3f_d000"),
        "the lock guards a sector too few": ("GUARD = 0x40_0000", "GUARD = 0x3f_f000"),
        "the lock can be undone": ("with m.If(self.lock):\n            m.d.sync += self.lowest.eq(GUARD)",
                                   "m.d.sync += self.lowest.eq(Mux(self.lock, GUARD, LOWEST))"),
        "the jump is not guarded": (" | (sector == JUMP >> 12)", ""),
        "an erase is not guarded": ("CHANGING = (Opcode.PAGE_PROGRAM, Opcode.SECTOR_ERASE)", "CHANGING = (Opcode.PAGE_PROGRAM,)"),
        "the address is taken when it is sent": ("header.bit_select(~index, 1)", "Cat(self.address, header[24:]).bit_select(~index, 1)"),
        "any opcode leaves": ("with m.If(known & ~guarded):", "with m.If(~guarded):"),
    }

    def harness(self, m, block):
        m.submodules.dut = dut = one_clock(block.FlashFrames(), "sync")
        clock = Signal(2)                       # 0, 1, 2, and 3 for ever
        m.d.formal += clock.eq(clock + ~clock.all())
        # One frame without data is enough for a bug, and many take the solver long.
        fixed = {} if self._with_lemmas else dict.fromkeys(("size", "abort", "take", "put", "put_word", "miso"), 0) | {
            "start": clock == 2, "lock": ~clock[1] & AnySeq(1)}
        for name in ("start", "opcode", "address", "size", "abort", "lock", "take", "put", "put_word", "miso"):
            port = getattr(dut, name)
            m.d.comb += port.eq(fixed.get(name, AnySeq(len(port))))

        # Whether the lock had been given when the frame was started: two clocks before the flash is selected.
        given, before, locked = Signal(name="given"), Signal(name="given_before"), Signal(name="locked")
        m.d.formal += [given.eq(given | dut.lock), before.eq(given)]
        # What the flash has received since it was selected: the opcode and the 12 highest bits of an address, the sector.
        seen, count, sck = Signal(20, name="seen"), Signal(range(21), name="count"), Signal(name="before")
        rises = dut.sck & ~sck & ~dut.cs_n
        m.d.formal += sck.eq(dut.sck)
        with m.If(dut.cs_n):
            m.d.formal += [seen.eq(0), count.eq(0), locked.eq(before)]
        with m.Elif(rises & (count != 20)):
            m.d.formal += [seen.eq(Cat(dut.mosi, seen)), count.eq(count + 1)]

        opcode, missing, beyond = Signal(8), Signal(6), Signal(4)       # bits to 32; bits behind the opcode
        m.d.comb += [missing.eq(32 - count), beyond.eq(Mux(count < 8, 0, count - 8)), opcode.eq(seen >> beyond)]
        changes, sector = (opcode == PROGRAM) | (opcode == ERASE), seen[:12]

        def may_change(sector, locked):
            return (sector >= LOWEST) & (sector != JUMP) & (~locked | (sector >= LOCKED))

        m.d.comb += [
            Assert((count < 8) | changes | Cat(opcode == code for code in HARMLESS).any()),
            Assert((count < 20) | ~changes | may_change(sector, locked)),
        ]

        # What induction needs to know of the inside: what the flash has seen is the beginning of the header.
        header, index, phase, addressed = dut._header, dut._index, dut._phase, dut._addressed
        select, in_header, between, data, end = dut._state
        code, under_way = header[24:], dut._state.any()
        m.d.comb += self.lemmas(
            ~dut.busy | Cat(code == c for c in (*HARMLESS, PROGRAM, ERASE)).any(),
            dut.lowest[12:] == Mux(given, LOCKED, LOWEST), ~before | given, ~locked | before,
            ~under_way | ~((code == PROGRAM) | (code == ERASE)) | may_change(header[12:24], Mux(dut.cs_n, before, locked)),
            ~dut.busy | (addressed == Cat(code == c for c in (0x03, PROGRAM, ERASE)).any()),
            under_way | dut.cs_n, dut.busy | (count == 0), ~(between | data | in_header) | ~dut.cs_n,
            ~(end & dut.cs_n) | (count == 0), ~(dut.busy & ~under_way) | (index == 0) | (count == 0),
            ~select | ((count == 0) & (index == 0)), ~select | (dut.cs_n == (phase == 0)), ~end | ~dut.cs_n,
            count <= 20, (count != 0) | (seen == 0),
            ~in_header | (count == Mux(index < 20, index, 20)), ~in_header | (phase == 0) | (dut.mosi == header.bit_select(~index, 1)),
            ~in_header | (dut.sck == ((phase == 3) | ((phase == 0) & (index != 0)))),
            ~in_header | (sck == ((phase[1] == 0) & (index != 0))), under_way & ~select & ~end | ~dut.sck,
            ~(between | data) | (count >= Mux(addressed, 20, 8)),
            ~dut.busy | (count == 0) | Mux(addressed | (count <= 8), seen == header >> missing, opcode == code),
        )
        m.d.comb += [
            Cover((count == 2) & (code == ERASE) & in_header & locked), Cover(end & (count == 1)),
            Cover(dut.refused & (dut.opcode == PROGRAM)),
            Cover(~dut.cs_n & (code == ERASE) & (header[12:24] == LOWEST)),
        ]
