# SPDX-License-Identifier: BSD-2-Clause
"""Ten thousand pulses at IN0 at any phase, all axes moving, the host flooding the main port: each record is where the board
says that the axes were, and none is lost."""

import binascii
import os
import struct
import subprocess
from collections import namedtuple

import pytest

from tb import toolchain
from tb.board import plant

AXES = 4
FAST_PS = 5000
LATCH = 3                   # clocks from the sample of a pin to what the time stamp says (docs/blocks/trigger.md)
BAUD = 115200

Pulse = namedtuple("Pulse", "edge counts")


def run(*lines, seed, pulses, gap_us):
    """``(pulses, [(start ps, byte)], replies)``; counts from where the board was at power-up, which is the user's 0."""
    with toolchain.firmware_lock():
        toolchain.run(["make", "--no-print-directory", "-C", "firmware", "../build/twin/triggers"], cwd=toolchain.ROOT)
    print(f"seed {seed}")
    done = subprocess.run([toolchain.BUILD / "twin" / "triggers", plant.render(plant.load(())), str(seed), str(pulses),
                           str(gap_us), *lines], capture_output=True, text=True, timeout=500, check=True)
    wanted, data, origin, replies = [], [], [], 0
    for line in done.stdout.splitlines():
        word, *numbers = line.split()
        numbers = [int(n) for n in numbers]
        if word == "pulse":
            wanted.append(Pulse(numbers[0], tuple(n - zero for n, zero in zip(numbers[1:], origin))))
        elif word == "byte":
            data.append(tuple(numbers))
        elif word == "power":
            origin = numbers
        else:
            replies, = numbers
    return wanted, data, replies


def binary(data):
    """Counts of each record as the original's."""
    size = 5 * AXES + 1
    assert len(data) % size == 0
    for at in range(0, len(data), size):
        fields = struct.unpack("<" + AXES * "Bi" + "B", data[at:at + size])
        assert fields[0::2] == (24, 25, 26, 27, 13)
        yield None, fields[1::2]


def ascii_lines(data):
    """The same from lines of text."""
    assert data.endswith(b"\r\n")
    for line in data.decode().split("\r\n")[:-1]:
        letters, counts = zip(*(field.split("=") for field in line.split(" ")))
        assert letters == tuple("XYZF")
        yield None, tuple(map(int, counts))


def extended(data):
    """Time and counts of each record with number, time and CRC."""
    head, size = b"\xaa\x55" + bytes([28]), 31
    assert len(data) % size == 0
    for n, at in enumerate(range(0, len(data), size)):
        record = data[at:at + size]
        number, time, *counts = struct.unpack("<HQ4i", record[3:-2])
        assert record.startswith(head) and number == n & 0xffff
        assert binascii.crc_hqx(record, 0xffff) == 0
        yield time, tuple(counts)


@pytest.fixture
def seed():
    return int(os.environ.get("SEED", "1"))


@pytest.mark.parametrize("setting, decode, pulses, gap_us", [
    ("TTL M=0", binary, 10_000, 1_920),         # records of 21 bytes take 1823 us: 95 % of what the line carries
    ("TTL M=1", ascii_lines, 1_000, 4_500),
    ("TTL M=2", extended, 1_000, 2_850),        # 2691 us
    ("TTLREPORT Y=1000000", binary, 5_000, 240),        # 210 us
], ids=["binary", "ascii", "extended", "1 Mbaud"])
def test_every_record_is_where_the_axes_were(seed, setting, decode, pulses, gap_us):
    wanted, data, replies = run("BU F=3", setting, "TTL X=1", seed=seed, pulses=pulses, gap_us=gap_us)
    records = list(decode(bytes(byte for _, byte in data)))
    assert len(wanted) == len(records) == pulses
    assert [counts for _, counts in records] == [pulse.counts for pulse in wanted]
    assert all(time in (None, pulse.edge + LATCH) for pulse, (time, _) in zip(wanted, records))
    # All axes went a long way; all phases of the processor's clock were met; and the main port was busy.
    for axis in range(AXES):
        assert sum(abs(a.counts[axis] - b.counts[axis]) for a, b in zip(wanted, wanted[1:])) > 20 * pulses
    assert {pulse.edge % 4 for pulse in wanted} == {0, 1, 2, 3}
    # The host had an answer every 4 ms at least, whatever the length of the version that some of them tell.
    seconds = (wanted[-1].edge - wanted[0].edge) * 5e-9
    assert replies > seconds / 4e-3
    print(f"{pulses} records in {seconds:.1f} s, {replies} replies meanwhile")


def test_the_line_is_never_idle_while_records_wait(seed):
    """Pulses much faster than the line: as many records as fit the line and the queue, none of them wrong, and each that
    was lost is counted."""
    wanted, data, _ = run("BU F=3", "TTL M=2", "TTL X=1", seed=seed, pulses=3_000, gap_us=200)
    records = list(extended(bytes(byte for _, byte in data)))
    of = {pulse.edge + LATCH: n for n, pulse in enumerate(wanted)}
    places = [of[time] for time, _ in records]
    assert places == sorted(places) and places[:1024] == list(range(1024))
    assert [counts for _, counts in records] == [wanted[place].counts for place in places]
    assert len(wanted) - len(records) > 1000
    starts = [start for start, _ in data]
    frame = 10 * 434 * 20_000
    gaps = [after - before - frame for before, after in zip(starts, starts[1:])]
    assert max(gaps) <= 3 * 20_000, f"idle for {max(gaps)} ps"
