# SPDX-License-Identifier: BSD-2-Clause
"""Eight analog channels: an SPI master for the converters MAX11120 to MAX11128, once around per servo tick.

Facts of the converter, of Maxim's data sheet "MAX11120-MAX11128, 1Msps, Low-Power, Serial 12-/10-/8-Bit, 4-/8-/16-Channel
ADCs" as public drivers quote it (github.com/emard/ulx3s-misc, examples/adc; Maxim's MAX11131 library for mbed): the
register codes and the fields of mode control (SCAN, CHSEL, RESET, CHAN_ID, SWCNV); words of 16 bits, the most
significant first; DIN is taken at the rising edge of SCLK, DOUT changes at the falling one; results carry their
channel in the top four bits and their value left-justified in the other twelve, whatever the part's resolution.  What
they do not agree on, the frame a result comes in and the idle level of SCLK, is found out.
"""

from amaranth import Array, Cat, Module, Mux, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.data import ArrayLayout
from amaranth.lib.wiring import In, Out, connect, flipped
from amaranth.utils import exact_log2

from rtl.registers import Field, Register, RegisterBank, action

__all__ = ["AdcPeripheral", "AdcScanner", "CHANNELS", "CONFIGURATION", "FRAME_CLOCKS", "SCAN_FRAMES"]

CHANNELS = 8
BITS = 12

CONFIGURATION = (0x0040, 0x8000, 0x8800, 0x9000, 0x9800)
"""Words before the first scan: reset all registers; no averaging, reference single-ended; inputs unipolar and
single-ended; none bipolar; none of twice the range."""

CONVERT = 0x0806
"""Mode control: convert one channel (SCAN 1), its number at ``CHANNEL_BIT``, and name it in the result (CHAN_ID)."""
CHANNEL_BIT = 7

LATENCY_FRAMES_MAX = 3
SCAN_FRAMES = CHANNELS + LATENCY_FRAMES_MAX
"""Frames of a scan: the result of a frame may come this many frames later, and the last ones must be fetched."""

HALF_CLOCKS = 4                 # of a period of sck
FRAME_HALVES = 1 + 32 + 1 + 2
FRAME_CLOCKS = FRAME_HALVES * HALF_CLOCKS
"""A frame and the pause after it: half a bit of lead, 16 bits, half a bit of trail, one bit deselected."""


class AdcScanner(wiring.Component):
    """Read all channels in turn after each ``tick``, and show them together at the next.  Domain ``sync``.

    On the clock after a ``tick``, ``values`` are those of the scan that the tick before it began: channel n was asked
    for in the frame for which ``cs_n`` falls 1 + n * ``FRAME_CLOCKS`` clocks after the edge that took that tick.  A
    scan takes ``SCAN_FRAMES * FRAME_CLOCKS`` clocks, 31.7 us; the first, and one after a failure,
    ``len(CONFIGURATION)`` frames more, 46.1 us.

    Results are put in their places by the channel number that they carry, so it does not matter how many frames
    later than its command a result comes.  A scan in which not all eight have come, because there is no converter, or
    it has lost its settings, is not shown; the next one configures the converter again, with the other idle level
    of ``sck``: converters may or may not count a falling edge before the first rising one, and the wrong way
    shifts the channel numbers, so that no scan is ever complete in it.

    Members
    -------
    tick : In(1)
        One-clock strobe.
    enable : In(1)
        Scan at ticks.
    cs_n, sck, mosi : Out(1)
        Pins, from flip-flops.  ``sck`` has a period of 8 clocks (6.25 MHz), ``mosi`` changes as it falls.
    miso : In(1)
        Pin, asynchronous; taken while ``sck`` is high, 5 clocks (100 ns) after it fell.
    values : Out(ArrayLayout(12, 8))
        0 after reset.
    valid : Out(1)
        ``values`` are of the scan before the last tick; otherwise they are older.
    idle_high : Out(1)
        Idle level of ``sck``.
    failed : Out(1)
        One-clock strobe: a scan ended without all channels.
    overrun : Out(1)
        One-clock strobe: a tick came during a scan and began none.
    """

    def __init__(self):
        super().__init__({
            "tick": In(1), "enable": In(1), "cs_n": Out(1, init=1), "sck": Out(1), "mosi": Out(1), "miso": In(1),
            "values": Out(ArrayLayout(unsigned(BITS), CHANNELS)), "valid": Out(1), "idle_high": Out(1),
            "failed": Out(1), "overrun": Out(1),
        })

    def elaborate(self, platform):
        m = Module()
        miso = Signal()
        m.submodules.miso_sync = FFSynchronizer(self.miso, miso)

        busy, configured = Signal(), Signal()
        frame = Signal(range(len(CONFIGURATION) + SCAN_FRAMES))
        clock = Signal(range(FRAME_CLOCKS))
        word, result = Signal(16), Signal(16)

        # The clocks of a frame, in halves of a bit: lead, 16 bits of low and high, trail, deselected.
        half = clock[exact_log2(HALF_CLOCKS):]
        half_ends = clock[:exact_log2(HALF_CLOCKS)].all()
        bits = (half >= 1) & (half <= 32)
        high = bits & ~half[0]
        m.d.sync += [
            self.cs_n.eq(~(busy & (half <= 33))),
            self.sck.eq(Mux(busy & bits, high, self.idle_high)),
            self.mosi.eq(busy & word[-1]),
        ]

        scanning = frame >= len(CONFIGURATION)
        channel = Mux(frame - len(CONFIGURATION) < CHANNELS, frame - len(CONFIGURATION), CHANNELS - 1)
        command = Mux(scanning, CONVERT | channel << CHANNEL_BIT, Array(CONFIGURATION)[frame])
        with m.If(busy):
            m.d.sync += clock.eq(clock + 1)
            with m.If(half == 0):
                m.d.sync += word.eq(command)
            with m.Elif(high & half_ends):
                m.d.sync += [word.eq(word << 1), result.eq(Cat(miso, result))]

        # Results of this scan, and which have come.
        scanned = Signal(ArrayLayout(unsigned(BITS), CHANNELS))
        come = Signal(CHANNELS)
        frame_ends = busy & (clock == FRAME_CLOCKS - 1)
        scan_ends = frame_ends & (frame == len(CONFIGURATION) + SCAN_FRAMES - 1)
        with m.If(frame_ends):
            m.d.sync += [clock.eq(0), frame.eq(frame + 1)]
        with m.If(frame_ends & scanning & (result[BITS:] < CHANNELS)):
            m.d.sync += scanned[result[BITS:BITS + 3]].eq(result[:BITS])
        take = Mux(result[BITS:] < CHANNELS, 1 << result[BITS:BITS + 3], 0)
        all_come = (come | take).all()
        with m.If(frame_ends & scanning):
            m.d.sync += come.eq(come | take)
        with m.If(scan_ends):
            m.d.sync += [busy.eq(0), configured.eq(all_come)]
            with m.If(~all_come):
                m.d.sync += self.idle_high.eq(~self.idle_high)
        m.d.comb += [self.failed.eq(scan_ends & ~all_come), self.overrun.eq(self.tick & busy)]

        complete = Signal()                     # a whole scan waits to be shown
        with m.If(scan_ends):
            m.d.sync += complete.eq(all_come)
        with m.If(self.tick):
            m.d.sync += [self.valid.eq(complete), complete.eq(0)]
            with m.If(complete):
                m.d.sync += self.values.eq(scanned)
            with m.If(self.enable & ~busy):
                m.d.sync += [busy.eq(1), clock.eq(0), come.eq(0),
                             frame.eq(Mux(configured, len(CONFIGURATION), 0))]
        return m


class AdcPeripheral(wiring.Component):
    """Eight analog channels on the CSR bus.  Domain ``sync``; pins as those of :class:`AdcScanner`.

    Members
    -------
    tick : In(1)
        The servo tick.
    cs_n, sck, mosi, miso
        Pins of the converter.
    """

    class Control(Register, access="rw"):
        """What to do at a servo tick."""
        enable: Field(action.RW, 1, doc="1: scan all channels after each servo tick.")

    class Status(Register, access="r"):
        """How it went."""
        valid: Field(action.R, 1, doc="The channels are of the scan that the servo tick before the last began; else they "
                                      "are older.")
        idle_high: Field(action.R, 1, doc="Idle level of the converter's clock, as found out.")

    class Events(Register, access="rw"):
        """What went wrong."""
        failed: Field(action.RW1C, 1, doc="A scan ended without all channels: no converter answers. The next configures "
                                          "it again. Write 1 to clear.")
        overrun: Field(action.RW1C, 1, doc="A servo tick came during a scan and began none: ticks are too fast. Write 1 "
                                           "to clear.")

    class Channel(Register, access="r"):
        """An analog input."""
        value: Field(action.R, unsigned(BITS), unit="1/4096 of the range",
                     doc="Shown at the last servo tick, all channels together; converted in the period before it.")

    def __init__(self):
        self._scanner = AdcScanner()
        self._registers = registers = RegisterBank(addr_width=4)
        self._channel = [registers.add(self.Channel, offset=4 * n, name=f"channel{n}") for n in range(CHANNELS)]
        self._status = registers.add(self.Status, offset=0x20)
        self._control = registers.add(self.Control, offset=0x24)
        self._events = registers.add(self.Events, offset=0x28)
        memory_map = registers.finish()
        super().__init__({"bus": In(registers.bus_signature), "tick": In(1), "cs_n": Out(1, init=1), "sck": Out(1),
                          "mosi": Out(1), "miso": In(1)})
        self.bus.memory_map = memory_map

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._registers
        m.submodules.scanner = scanner = self._scanner
        connect(m, flipped(self.bus), self._registers.bus)
        m.d.comb += [
            scanner.tick.eq(self.tick), scanner.enable.eq(self._control.f.enable.data),
            self.cs_n.eq(scanner.cs_n), self.sck.eq(scanner.sck), self.mosi.eq(scanner.mosi),
            scanner.miso.eq(self.miso),
            self._status.f.valid.r_data.eq(scanner.valid), self._status.f.idle_high.r_data.eq(scanner.idle_high),
            self._events.f.failed.set.eq(scanner.failed), self._events.f.overrun.set.eq(scanner.overrun),
            *(register.f.value.r_data.eq(scanner.values[n]) for n, register in enumerate(self._channel)),
        ]
        return m
