# SPDX-License-Identifier: BSD-2-Clause
"""A serial NOR flash at its pins, for tests of blocks: SPI mode 0, the commands that the controller uses, no busy time of its own.

Not the board model's (tb/board/nor.c), which has power cuts and contents of 16 MiB, so that one can be wrong without the other.
"""


class Nor:
    """``frames``: the bytes of each selection, as received.  ``busy_reads``: how often the status says busy after a change."""

    IDENTIFICATION = (0xef, 0x40, 0x18)

    def __init__(self, *, busy_reads=2):
        self.memory, self.frames, self.faults = {}, [], []
        self._busy_reads, self._busy, self._enabled = busy_reads, 0, False
        self._cs_n, self._sck, self._bits, self._bytes, self._out = 1, 0, 0, [], 1

    def pins(self, cs_n, sck, mosi):
        """The pins are like this now; returns the level of MISO, 1 when it is not driven."""
        if cs_n != self._cs_n:
            self._cs_n = cs_n
            if cs_n:
                self._deselected()
            else:
                self._bits, self._bytes = 0, []
                if sck:
                    self.faults.append("selected while sck is high")
        elif not cs_n and sck and not self._sck:
            if self._bits % 8 == 0:
                self._bytes.append(0)
            self._bytes[-1] = self._bytes[-1] << 1 | mosi
            self._bits += 1
        elif not cs_n and self._sck and not sck:
            self._out = self._answer() >> (7 - self._bits % 8) & 1
        self._sck = sck
        return self._out if not cs_n else 1

    def _address(self):
        return int.from_bytes(self._bytes[1:4], "big")

    def _answer(self):
        """The byte that is being sent."""
        n, command = self._bits // 8, self._bytes[0]
        if n < 1:
            return 0xff
        if command == 0x9f:
            return self.IDENTIFICATION[(n - 1) % 3]
        if command == 0x05:
            return (self._busy > 0) | self._enabled << 1
        if command == 0x03 and n >= 4:
            return self.memory.get((self._address() + n - 4) % (1 << 24), 0xff)
        return 0xff

    def _deselected(self):
        self.frames.append(bytes(self._bytes))
        if self._bits % 8 or not self._bytes:
            return
        command = self._bytes[0]
        if self._busy:
            if command == 0x05:
                self._busy -= 1
            else:
                self.faults.append(f"command {command:#x} while busy")
        elif command == 0x06:
            self._enabled = True
        elif command in (0x02, 0x20):
            if not self._enabled:
                self.faults.append("a change that is not enabled")
                return
            self._enabled, self._busy, address = False, self._busy_reads, self._address()
            if command == 0x20:
                first = address & ~0xfff
                self.memory = {a: v for a, v in self.memory.items() if not first <= a < first + 4096}
            for n, byte in enumerate(self._bytes[4:] if command == 0x02 else ()):
                at = address & ~0xff | (address + n) & 0xff
                self.memory[at] = self.memory.get(at, 0xff) & byte
