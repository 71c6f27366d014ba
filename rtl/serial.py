# SPDX-License-Identifier: BSD-2-Clause
"""The serial port: 8 data bits, no parity, 1 stop bit, with a FIFO each way."""

from amaranth import Module, Mux, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out, connect, flipped

from rtl.registers import Field, FifoPort, Register, RegisterBank, action
from amaranth_stdio.serial import AsyncSerialRX, AsyncSerialTX

__all__ = ["FIFO_BYTES", "SerialPeripheral"]

FIFO_BYTES = 64
"""Bytes in each FIFO, unless built otherwise."""

MIN_DIVISOR = 8
ERRORS_MAX = 0xffff


class Receiver(wiring.Component):
    """Bytes from the pin.  Domain ``sync``.

    A frame that does not end in a stop bit is dropped and reported, and nothing is received again until the
    line has been high: a break of any length is one error and no byte.  A far end that is 3 % fast or slow is
    understood from 16 clocks per bit up.

    Members
    -------
    rx : In(1)
        Pin, asynchronous; idles high.
    divisor : In(16)
        Clocks per bit, at least 8.
    data, valid : Out(8), Out(1)
        A byte; ``valid`` is a one-clock strobe in the middle of the stop bit.
    framing, line_break : Out(1)
        One-clock strobes, one of them for each dropped frame: ``line_break`` when all its bits were 0.
    """

    rx: In(1)
    divisor: In(16)
    data: Out(8)
    valid: Out(1)
    framing: Out(1)
    line_break: Out(1)

    def elaborate(self, platform):
        m = Module()
        m.submodules.core = core = AsyncSerialRX(divisor=MIN_DIVISOR, divisor_bits=16)
        line = Signal(init=1)
        m.submodules.rx_sync = FFSynchronizer(self.rx, line, init=1)

        # The core would take a line that stays low for the next start bit; show it an idle line instead.
        failed = Signal()
        waiting = Signal()
        m.d.comb += failed.eq(core.rdy & core.err.frame)
        m.d.sync += waiting.eq((failed | waiting) & ~line)
        m.d.comb += [
            core.divisor.eq(self.divisor), core.ack.eq(1), core.i.eq(line | failed | waiting),
            self.data.eq(core.data), self.valid.eq(core.rdy & ~core.err.frame),
            self.line_break.eq(failed & (core.data == 0)), self.framing.eq(failed & (core.data != 0)),
        ]
        return m


class SerialPeripheral(wiring.Component):
    """The serial port on the CSR bus.  Domain ``sync``.

    ``interrupt`` is high while a condition enabled in ``InterruptEnable`` holds.

    Parameters
    ----------
    depth : int
        Bytes in each FIFO, at least 64.

    Members
    -------
    rx, tx : In(1), Out(1)
        Pins; they idle high.  ``tx`` comes from a flip-flop.
    """

    class Data(Register, access="rw"):
        """The FIFOs. Reading takes a byte out (the one side effect of a read); writing sends one."""
        byte: Field(FifoPort, 8, doc="Read: the oldest received byte, taken out. Write: sent after those "
                                     "written before; lost when Status.tx_ready is 0.")
        valid: Field(action.R, 1, doc="The byte read with it is real: the FIFO was not empty.")

    class Status(Register, access="r"):
        """State of the FIFOs and of the transmitter."""
        rx_ready: Field(action.R, 1, doc="At least one received byte waits.")
        tx_ready: Field(action.R, 1, doc="There is room for a byte to send.")
        tx_low: Field(action.R, 1, doc="The FIFO of bytes to send is at most half full.")
        tx_idle: Field(action.R, 1, doc="Everything written has left the pin, stop bit included.")

    class Errors(Register, access="rw"):
        """What went wrong since the bit was cleared."""
        rx_overrun: Field(action.RW1C, 1, doc="A byte was lost because the FIFO was full. Write 1 to clear.")
        framing: Field(action.RW1C, 1, doc="A frame without a stop bit was dropped. Write 1 to clear.")
        line_break: Field(action.RW1C, 1, doc="The line was low for a whole frame. Write 1 to clear.")

    class ErrorCount(Register, access="r"):
        """Quality of the line."""
        frames: Field(action.R, unsigned(16), unit="frames",
                      doc="Frames dropped since reset for want of a stop bit, breaks included. Saturates.")

    class Divisor(Register, access="rw"):
        """Bit rate. Taken at the next bit: change it while nothing is sent or received."""
        value: Field(action.RW, unsigned(16), init=434, unit="clocks",
                     doc="Clocks per bit; below 8 acts as 8. 434 is 115200 bit/s at 50 MHz.")

    class InterruptEnable(Register, access="rw"):
        """Conditions that hold the interrupt line."""
        rx_ready: Field(action.RW, 1, doc="Interrupt while Status.rx_ready.")
        tx_low: Field(action.RW, 1, doc="Interrupt while Status.tx_low.")
        error: Field(action.RW, 1, doc="Interrupt while any bit of Errors is set.")

    def __init__(self, *, depth=FIFO_BYTES):
        if depth < 64:
            raise ValueError(f"depth must be at least 64, not {depth!r}")
        self._depth = depth
        self._registers = registers = RegisterBank(addr_width=3)
        self._data = registers.add(self.Data, offset=0x00)
        self._status = registers.add(self.Status, offset=0x04)
        self._errors = registers.add(self.Errors, offset=0x08)
        self._error_count = registers.add(self.ErrorCount, offset=0x0c)
        self._divisor = registers.add(self.Divisor, offset=0x10)
        self._enable = registers.add(self.InterruptEnable, offset=0x14)
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "interrupt": Out(1), "rx": In(1, init=1),
                          "tx": Out(1, init=1)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.receiver = receiver = Receiver()
        m.submodules.transmitter = transmitter = AsyncSerialTX(divisor=MIN_DIVISOR, divisor_bits=16)
        m.submodules.rx_fifo = rx_fifo = SyncFIFOBuffered(width=8, depth=self._depth)
        m.submodules.tx_fifo = tx_fifo = SyncFIFOBuffered(width=8, depth=self._depth)
        connect(m, flipped(self.bus), self._registers.bus)

        divisor = Signal(16)
        written = self._divisor.f.value.data
        m.d.comb += [
            divisor.eq(Mux(written < MIN_DIVISOR, MIN_DIVISOR, written)),
            receiver.divisor.eq(divisor), transmitter.divisor.eq(divisor),
        ]

        data, status, errors, enable = self._data.f, self._status.f, self._errors.f, self._enable.f
        m.d.comb += [
            receiver.rx.eq(self.rx),
            rx_fifo.w_data.eq(receiver.data), rx_fifo.w_en.eq(receiver.valid),
            data.byte.r_data.eq(rx_fifo.r_data), data.valid.r_data.eq(rx_fifo.r_rdy),
            rx_fifo.r_en.eq(data.byte.r_stb),
            errors.rx_overrun.set.eq(receiver.valid & ~rx_fifo.w_rdy),
            errors.framing.set.eq(receiver.framing), errors.line_break.set.eq(receiver.line_break),
        ]
        frames = self._error_count.f.frames.r_data
        dropped = Signal.like(frames)
        with m.If((receiver.framing | receiver.line_break) & (dropped != ERRORS_MAX)):
            m.d.sync += dropped.eq(dropped + 1)
        m.d.comb += frames.eq(dropped)

        # The transmitter's last flip-flop is still sending when it is ready for more: idle is one bit later.
        idle_for = Signal(17)
        with m.If(tx_fifo.r_rdy | ~transmitter.rdy):
            m.d.sync += idle_for.eq(0)
        with m.Elif(idle_for <= divisor):
            m.d.sync += idle_for.eq(idle_for + 1)
        m.d.comb += [
            tx_fifo.w_data.eq(data.byte.w_data), tx_fifo.w_en.eq(data.byte.w_stb),
            transmitter.data.eq(tx_fifo.r_data), transmitter.ack.eq(tx_fifo.r_rdy),
            tx_fifo.r_en.eq(transmitter.rdy),
            self.tx.eq(transmitter.o),
            status.rx_ready.r_data.eq(rx_fifo.r_rdy), status.tx_ready.r_data.eq(tx_fifo.w_rdy),
            status.tx_low.r_data.eq(tx_fifo.level <= self._depth // 2),
            status.tx_idle.r_data.eq((idle_for > divisor) & ~tx_fifo.r_rdy & (tx_fifo.level == 0)),
        ]
        any_error = errors.rx_overrun.data | errors.framing.data | errors.line_break.data
        m.d.comb += self.interrupt.eq(
            (enable.rx_ready.data & status.rx_ready.r_data) | (enable.tx_low.data & status.tx_low.r_data)
            | (enable.error.data & any_error))
        return m
