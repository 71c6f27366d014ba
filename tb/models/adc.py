# SPDX-License-Identifier: BSD-2-Clause
"""An analog-to-digital converter of the family MAX11120 to MAX11128, as its pins and its host see it.

From Maxim's data sheet of the family, as public drivers quote it: 16-bit words, DIN taken at rising edges of SCLK, DOUT changing after falling ones; the mode
control register (bit 15 is 0) with SCAN in bits 14 to 11, CHSEL 10 to 7, RESET 6 to 5, PM 4 to 3, CHAN_ID 2; the registers
behind the codes 10000 to 10110.  Time comes in from outside, in nanoseconds.
"""

__all__ = ["Adc"]

DATA_VALID_NS = 15.5                    # falling edge of SCLK to DOUT, most
SETUP_NS, HOLD_NS = 4, 1                # DIN around the rising edge
CLOCK_NS, DESELECTED_NS = 62.5, 5       # least

MANUAL, NULL = 1, 0
CHAN_ID = 4


class Adc:
    """A converter with eight inputs.  Call :meth:`pins` at each change of its pins; read ``dout``.

    Parameters
    ----------
    bits : int
        Resolution, 8, 10 or 12.
    latency : int
        Frames from the command to its result, at least 1.
    first_edge : bool
        The most significant bit comes with the first falling edge of a frame; else with its selection.
    """

    def __init__(self, *, bits=12, latency=1, first_edge=False):
        self.inputs = [0.0] * 8         # fractions of the range
        self.registers = {}
        self.frames = []                # words received, whole frames only
        self.conversions = []           # (time of its selection, channel)
        self.selected_at = []
        self._bits, self._first_edge = bits, first_edge
        self._due = [0xffff] * (latency - 1)  # results that wait for their frame
        self._cs_n, self._sck, self._din = 1, None, None
        self._changed_ns, self._rose_ns, self._deselected_ns = -1e9, -1e9, -1e9
        self.power_up()

    def power_up(self):
        self.registers = {"config": 0, "unipolar": None, "bipolar": None, "range": None}
        self._channel, self._mode, self._names = 0, NULL, False
        self._shift_out, self._received = 0, []
        self._dout = (1, 1, -1e9)

    def dout(self, now_ns):
        """The level at a time; while it may be changing it is 2."""
        before, after, at_ns = self._dout
        if self._cs_n:
            return 1                    # high impedance, and a pull-up
        return after if now_ns >= at_ns + DATA_VALID_NS or before == after else 2

    def _put(self, level, now_ns):
        self._dout = (self._dout[1], level, now_ns)

    def pins(self, now_ns, cs_n, sck, din):
        if din != self._din:
            assert cs_n or now_ns - self._rose_ns >= HOLD_NS, "DIN was not held"
            self._din, self._changed_ns = din, now_ns
        if cs_n != self._cs_n:
            assert sck == self._sck, "SCLK moved with CS"
            self._cs_n = cs_n
            if cs_n:
                self._end()
                self._deselected_ns = now_ns
            else:
                assert now_ns - self._deselected_ns >= DESELECTED_NS, "CS was high too shortly"
                self._begin(now_ns)
        elif sck != self._sck and not cs_n:
            if sck:
                self._rise(now_ns)
            else:
                self._fall(now_ns)
        self._sck = sck

    def _begin(self, now_ns):
        result = self._convert(now_ns)
        self._due.append(result)
        self._shift_out = self._due.pop(0)
        self._received, self._falls = [], 0
        self._put(self._shift_out >> 15, now_ns)

    def _fall(self, now_ns):
        self._falls += 1
        place = 15 - self._falls + self._first_edge
        self._put(self._shift_out >> place & 1 if place >= 0 else 0, now_ns)

    def _rise(self, now_ns):
        assert now_ns - self._changed_ns >= SETUP_NS, "DIN was not set up"
        if self._received:
            assert now_ns - self._rose_ns >= CLOCK_NS, "SCLK is too fast"
        self._rose_ns = now_ns
        self._received.append(self._din)

    def _end(self):
        if len(self._received) != 16:
            return
        word = int("".join(map(str, self._received)), 2)
        self.frames.append(word)
        if word >> 15:
            name = {16: "config", 17: "unipolar", 18: "bipolar", 19: "range"}.get(word >> 11)
            assert name, f"a register that we do not use: {word:#06x}"
            self.registers[name] = word & 0x7ff
        elif word >> 5 & 3 == 2:
            self.power_up()
        elif word >> 11:
            self._mode, self._channel, self._names = word >> 11, word >> 7 & 0xf, bool(word & CHAN_ID)

    def _convert(self, now_ns):
        """The word of the conversion that the last command asked for."""
        if self._mode != MANUAL:
            return 0
        self.conversions.append((now_ns, self._channel))
        full = 1 << self._bits
        code = min(full - 1, max(0, int(self.inputs[self._channel] * full)))
        return (self._channel << 12 if self._names else 0) | code << 12 - self._bits
