# SPDX-License-Identifier: BSD-2-Clause
"""The configuration flash: whole SPI NOR frames, of a few harmless kinds, and parts of it that nothing can change.

Commands and times are those that all serial NOR flashes of the class share (JEDEC JESD216; Winbond W25Q128JV, ISSI IS25LP128):
SPI mode 0, the most significant bit first, 3-byte addresses, sectors of 4 KiB, pages of 256 bytes, at least 50 MHz for plain reads.
"""

from enum import IntEnum

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.registers import Field, FifoPort, Register, RegisterBank, action

__all__ = ["FlashFrames", "FlashPeripheral", "GUARD", "JUMP", "LOWEST", "Opcode", "SECTOR"]

SECTOR = 4096
LOWEST = 0x3f_e000
"""Below this byte the bitstreams lie; it can be read, never erased or programmed."""

GUARD = 0x40_0000
"""The same, once ``lock`` has been given: the boot program's own sectors lie between."""

JUMP = 0xff_f000
"""The last sector of 16 MiB, with the FPGA's jump to a second bitstream: never erased or programmed either."""

BIT_CLOCKS = 4
REST_CLOCKS = 8


class Opcode(IntEnum):
    """The frames that leave the chip; everything else is refused."""
    PAGE_PROGRAM = 0x02
    READ = 0x03
    READ_STATUS = 0x05
    WRITE_ENABLE = 0x06
    SECTOR_ERASE = 0x20
    READ_ID = 0x9f
    WAKE = 0xab


ADDRESSED = (Opcode.READ, Opcode.PAGE_PROGRAM, Opcode.SECTOR_ERASE)
READING = (Opcode.READ, Opcode.READ_STATUS, Opcode.READ_ID)
CHANGING = (Opcode.PAGE_PROGRAM, Opcode.SECTOR_ERASE)


class FlashFrames(wiring.Component):
    """One frame at a time: opcode, address where it has one, data.  Domain ``sync``.

    A frame takes ``4`` clocks from ``start`` to the first bit, 4 clocks a bit (12.5 MHz), 2 or 3 more after each byte, and
    ``4 + REST_CLOCKS`` at its end.  It waits, its clock low, while a word of data is not there or not taken.

    A frame that is not an :class:`Opcode`, one that would change something below ``lowest`` or in the sector :data:`JUMP`, and one
    that is started while another is under way, are refused: nothing leaves.  A frame changes nothing beyond the sector of its
    address: a flash that programs wraps within a page.

    Members
    -------
    start : In(1)
        Strobe: begin a frame.
    opcode, address, size : In(8), In(24), In(16)
        Of the frame, taken at ``start``.  ``size``: bytes of data; without meaning for frames that have none.
    lock : In(1)
        Strobe: from now on ``lowest`` is :data:`GUARD`.  Nothing undoes it but the reset of ``sync``.
    lowest : Out(24)
        First byte that may be erased or programmed: :data:`LOWEST` or :data:`GUARD`, as of ``start``.
    abort : In(1)
        Strobe: end the frame under way after at most 4 clocks, wherever it is.
    busy : Out(1)
        A frame is under way, or the rest after it.
    refused : Out(1)
        The last ``start`` was refused.
    word : Out(32)
        Four bytes read, the first in the lowest bits; the last word of a frame may have fewer.
    ready : Out(1)
        Reading: ``word`` is there.  Programming: ``put`` is taken.
    take : In(1)
        Strobe: ``word`` has been read.
    put, put_word : In(1), In(32)
        Strobe with four bytes to program; lost when not ``ready``.
    cs_n, sck, mosi : Out(1)
        Pins, from flip-flops.  ``mosi`` changes as ``sck`` falls.
    miso : In(1)
        Pin, asynchronous; taken as ``sck`` rises, 40 ns after it fell.
    """

    def __init__(self):
        # Opcode and address as they are sent, most significant bit first; and what a proof wants to know of the inside.
        self._header, self._addressed = Signal(32, name="header"), Signal(name="addressed")
        self._phase, self._index = Signal(2, name="phase"), Signal(5, name="index")         # of a bit's clocks; of the bits
        self._state = Signal(5)
        super().__init__({
            "start": In(1), "opcode": In(8), "address": In(24), "size": In(16), "abort": In(1), "busy": Out(1), "refused": Out(1),
            "lock": In(1), "lowest": Out(24, init=LOWEST),
            "word": Out(32), "ready": Out(1), "take": In(1), "put": In(1), "put_word": In(32),
            "cs_n": Out(1, init=1), "sck": Out(1), "mosi": Out(1), "miso": In(1),
        })

    def elaborate(self, platform):
        m = Module()
        miso = Signal()
        m.submodules.miso_sync = FFSynchronizer(self.miso, miso)

        header, addressed, phase, index = self._header, self._addressed, self._phase, self._index
        reading, changing = Signal(), Signal()
        known, guarded, sector = Signal(), Signal(), self.address[12:]
        m.d.comb += [
            known.eq(Cat(self.opcode == code for code in Opcode).any()),
            guarded.eq(Cat(self.opcode == code for code in CHANGING).any()
                       & ((sector < self.lowest[12:]) | (sector == JUMP >> 12))),
        ]
        with m.If(self.lock):
            m.d.sync += self.lowest.eq(GUARD)

        left, lane = Signal(16), Signal(2)              # bytes to come; place of the next in its word
        shift, assembled = Signal(8), Signal(32)
        fetched, full, waiting = Signal(), Signal(), Signal()   # a byte in shift; a word in assembled; a word in self.word
        # A bit is on the pin when the synchroniser's flip-flops have it: 2 clocks after it was sampled.
        sampled = Signal()
        m.d.sync += sampled.eq(0)
        with m.If(sampled & reading):
            m.d.sync += shift.eq(Cat(miso, shift))

        with m.If(self.take):
            m.d.sync += waiting.eq(0)
        with m.If(self.put & self.ready & changing):
            m.d.sync += [self.word.eq(self.put_word), waiting.eq(1)]
        m.d.comb += self.ready.eq(Mux(changing, self.busy & ~waiting, waiting))

        def abort():
            """In a state of a frame: an end of it that was asked for comes before everything else."""
            with m.If(self.abort):
                m.d.sync += [phase.eq(0), self.sck.eq(0)]
                m.next = "END"

        m.d.sync += self.sck.eq(0)
        with m.FSM() as fsm:
            with m.State("IDLE"):
                m.d.sync += [phase.eq(0), index.eq(0), lane.eq(0), fetched.eq(0), full.eq(0)]
                with m.If(self.start):
                    m.d.sync += self.refused.eq(~known | guarded)
                    with m.If(known & ~guarded):
                        m.d.sync += [
                            header.eq(Cat(self.address, self.opcode)), waiting.eq(0),
                            addressed.eq(Cat(self.opcode == code for code in ADDRESSED).any()),
                            reading.eq(Cat(self.opcode == code for code in READING).any()),
                            changing.eq(Cat(self.opcode == code for code in CHANGING).any()),
                            left.eq(Mux(Cat(self.opcode == code for code in (*READING, Opcode.PAGE_PROGRAM)).any(), self.size, 0)),
                        ]
                        m.next = "SELECT"
            with m.State("SELECT"):
                m.d.sync += [self.cs_n.eq(0), phase.eq(phase + 1)]
                with m.If(phase.all()):
                    m.next = "HEADER"
                abort()
            with m.State("HEADER"):
                m.d.sync += [phase.eq(phase + 1), self.sck.eq(phase[1])]
                with m.If(phase == 0):
                    m.d.sync += self.mosi.eq(header.bit_select(~index, 1))
                with m.If(phase.all()):
                    m.d.sync += index.eq(index + 1)
                    with m.If(Mux(addressed, index.all(), index[:3].all())):
                        m.next = "BYTE"
                abort()
            with m.State("BYTE"):
                m.d.sync += index.eq(0)
                with m.If(fetched & ~sampled):
                    m.d.sync += [assembled.word_select(lane, 8).eq(shift), fetched.eq(0), lane.eq(lane + 1),
                                 full.eq(lane.all() | (left == 0))]
                with m.Elif(full):
                    with m.If(~waiting):
                        m.d.sync += [self.word.eq(assembled), waiting.eq(1), full.eq(0)]
                with m.Elif(~fetched):
                    with m.If(left == 0):
                        m.next = "END"
                    with m.Elif(reading):
                        m.d.sync += left.eq(left - 1)
                        m.next = "DATA"
                    with m.Elif(lane != 0):
                        m.d.sync += [shift.eq(assembled.word_select(lane, 8)), lane.eq(lane + 1), left.eq(left - 1)]
                        m.next = "DATA"
                    with m.Elif(waiting):
                        m.d.sync += [assembled.eq(self.word), waiting.eq(0), shift.eq(self.word[:8]), lane.eq(1), left.eq(left - 1)]
                        m.next = "DATA"
                abort()
            with m.State("DATA"):
                m.d.sync += [phase.eq(phase + 1), self.sck.eq(phase[1])]
                with m.If((phase == 0) & changing):
                    m.d.sync += [self.mosi.eq(shift[7]), shift.eq(shift << 1)]
                with m.If(phase.all()):
                    m.d.sync += [index.eq(index + 1), sampled.eq(1)]
                    with m.If(index[:3].all()):
                        m.d.sync += fetched.eq(reading)
                        m.next = "BYTE"
                abort()
            with m.State("END"):
                m.d.sync += [phase.eq(phase + 1), index.eq(0)]
                with m.If(phase.all()):
                    m.d.sync += self.cs_n.eq(1)
                    m.next = "REST"
            with m.State("REST"):
                m.d.sync += index.eq(index + 1)
                with m.If(index == REST_CLOCKS - 1):
                    m.next = "IDLE"
        m.d.comb += self.busy.eq(~fsm.ongoing("IDLE"))
        with m.If(self.start & self.busy):
            m.d.sync += self.refused.eq(1)
        m.d.comb += self._state.eq(Cat(fsm.ongoing(state) for state in ("SELECT", "HEADER", "BYTE", "DATA", "END")))
        return m


class FlashPeripheral(wiring.Component):
    """The flash on the CSR bus.  Domain ``sync``; frames and pins as those of :class:`FlashFrames`.

    To read: write ``Address``, then ``Frame``; take ``Data`` whenever ``Status.ready``, a word for each four bytes begun.  To change
    something: a frame WRITE_ENABLE, then the one that changes, its words written to ``Data`` whenever ``Status.ready``; then READ_STATUS
    until bit 0 of the flash's own status is 0.

    Members
    -------
    cs_n, sck, mosi, miso
        Pins of the flash.
    """

    class Data(Register, access="rw"):
        """Four bytes of the frame, the first in the lowest bits. Reading takes them (the one side effect of a read)."""
        word: Field(FifoPort, 32, doc="Real, or taken, when Status.ready is set.")

    class Address(Register, access="rw"):
        """Where the next frame reads, programs or erases."""
        value: Field(action.RW, unsigned(24), unit="bytes", doc="Taken with Frame.")

    class Frame(Register, access="w"):
        """Writing it begins a frame."""
        opcode: Field(action.W, 8, doc="2 program, 3 read, 5 read status, 6 write enable, 0x20 erase a sector, 0x9f read the "
                                       "identification, 0xab wake. Any other is refused.")
        size: Field(action.W, 16, unit="bytes", doc="Data of the frame; up to 256 to program.")

    class Status(Register, access="r"):
        """State of the frame."""
        busy: Field(action.R, 1, doc="A frame is under way.")
        ready: Field(action.R, 1, doc="Reading: Data holds bytes. Programming: Data takes bytes.")
        refused: Field(action.R, 1, doc="The last frame was refused: an opcode that is not known, something that cannot be changed, "
                                        "or a frame was under way. Nothing left the chip.")

    class Control(Register, access="w"):
        """Commands."""
        abort: Field(action.W, 1, doc="1: the frame under way ends here.")
        lock: Field(action.W, 1, doc="1: Guard rises to 0x400000. Nothing undoes it but power-up or a reset of the whole gateware; "
                                     "a reset of the processor does not.")

    class Guard(Register, access="r"):
        """What software cannot change: all below, and the last sector, from 0xfff000 on."""
        lowest: Field(action.R, unsigned(24), unit="bytes", doc="The first byte that may be erased or programmed: 0x3fe000 at "
                                                                "power-up, 0x400000 after Control.lock.")

    def __init__(self):
        self._frames = FlashFrames()
        self._registers = registers = RegisterBank(addr_width=3)
        self._data = registers.add(self.Data, offset=0x00)
        self._address = registers.add(self.Address, offset=0x04)
        self._frame = registers.add(self.Frame, offset=0x08)
        self._status = registers.add(self.Status, offset=0x0c)
        self._control = registers.add(self.Control, offset=0x10)
        self._lowest = registers.add(self.Guard, offset=0x14)
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "cs_n": Out(1, init=1), "sck": Out(1), "mosi": Out(1),
                          "miso": In(1)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.frames = frames = self._frames
        connect(m, flipped(self.bus), self._registers.bus)
        data, frame, status = self._data.f.word, self._frame.f, self._status.f
        m.d.comb += [
            frames.start.eq(frame.opcode.w_stb), frames.opcode.eq(frame.opcode.w_data), frames.size.eq(frame.size.w_data),
            frames.address.eq(self._address.f.value.data),
            frames.abort.eq(self._control.f.abort.w_stb & self._control.f.abort.w_data),
            frames.lock.eq(self._control.f.lock.w_stb & self._control.f.lock.w_data),
            data.r_data.eq(frames.word), frames.take.eq(data.r_stb), frames.put_word.eq(data.w_data), frames.put.eq(data.w_stb),
            status.busy.r_data.eq(frames.busy), status.ready.r_data.eq(frames.ready), status.refused.r_data.eq(frames.refused),
            self._lowest.f.lowest.r_data.eq(frames.lowest),
            self.cs_n.eq(frames.cs_n), self.sck.eq(frames.sck), self.mosi.eq(frames.mosi), frames.miso.eq(self.miso),
        ]
        return m
