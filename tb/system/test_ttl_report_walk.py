# SPDX-License-Identifier: BSD-2-Clause
"""From a pulse at IN0 to the bytes on the report port, on the real firmware in the real gateware.

Where the axes were is worked out from the recorded encoder pins: what each sample of a pin saw, and nothing of the decoders.
"""

import binascii
import bisect
import random
import struct

import numpy
import pytest

from tb import toolchain
from tb.models.encoder import CIRCLE
from tb.sim.simulator import FAST_PERIOD_PS, MS, S, SIGNALS, SYNC_PERIOD_PS, US
from tb.system.test_budgets import PERIOD_CLOCKS, log_has, reply_us, tick_clocks

AXES = "xyzf"
FRAME_PS = 10 * 434 * SYNC_PERIOD_PS        # start bit, byte, stop bit at 115200
RECORD = 5 * len(AXES) + 1
LATCH = 4                                   # clocks from the sample of IN0 to the last axis' latch, without filters


def sample_after(time_ps):
    """The clock of ``fast`` that is the first to sample what changes at a time."""
    return time_ps // FAST_PERIOD_PS + 1


class Pins:
    """What was recorded of the encoders, from a moment at which all stood at known counts."""

    def __init__(self, changes, levels, counts):
        """``levels`` and ``counts``: at that moment, by signal and by axis."""
        self._clocks, self._counts = {}, {}
        names = {SIGNALS.index(f"{axis}_{wire}"): (axis, wire) for axis in AXES for wire in "ab"}
        levels, place = dict(levels), dict(counts)
        for axis in AXES:
            self._clocks[axis], self._counts[axis] = [0], [place[axis]]
        for time_ps, signal, level in changes.tolist():
            if signal not in names:
                continue
            axis, wire = names[signal]
            before = CIRCLE.index(f"{levels[f'{axis}_a']}{levels[f'{axis}_b']}")
            levels[f"{axis}_{wire}"] = level
            after = CIRCLE.index(f"{levels[f'{axis}_a']}{levels[f'{axis}_b']}")
            place[axis] += {1: 1, 3: -1}[(after - before) % 4]
            self._clocks[axis].append(sample_after(time_ps))
            self._counts[axis].append(place[axis])

    def at(self, clock):
        """Counts of all axes as the sample of a clock shows them."""
        return tuple(self._counts[axis][bisect.bisect_right(self._clocks[axis], clock) - 1] for axis in AXES)


@pytest.fixture
def reporting(powered):
    """In the profile of TTL_REPORT_INT; ``M`` of TTL is the test's to choose."""
    assert powered.command("BU F=3") == ":A \r\n"
    return powered


def where(sim):
    return {axis: sim.count(n) for n, axis in enumerate(AXES)}


def play(sim, times_ps, *, length_ps=150_000, lines=b""):
    """Pulses at IN0 that begin at these times; lines are sent meanwhile.  What the pins showed."""
    sim.record(*(f"{axis}_{wire}" for axis in AXES for wire in "ab"))
    levels, counts, taken = sim.levels(), where(sim), []
    for time_ps in times_ps:
        sim.schedule_input(time_ps, "in0", 1)
        sim.schedule_input(time_ps + length_ps, "in0", 0)
    while sim.time_ps < times_ps[-1] + 10 * MS:
        if lines and sim.serial_unsent < 16:
            sim.serial_write(lines)
        sim.run(1 * MS)
        taken.append(sim.changes())
    sim.record()
    return Pins(numpy.concatenate(taken), levels, counts)


def binary(data):
    assert len(data) % RECORD == 0
    for at in range(0, len(data), RECORD):
        fields = struct.unpack("<" + len(AXES) * "Bi" + "B", data[at:at + RECORD])
        assert fields[0::2] == (24, 25, 26, 27, 13)
        yield fields[1::2]


def random_times(rng, begin_ps, count, gap_ps):
    times = [begin_ps]
    while len(times) < count:
        times.append(times[-1] + rng.randrange(400_000, 2 * gap_ps))
    return times


def move_all(sim, rng):
    places = " ".join(f"{axis}={rng.choice((-1, 1)) * rng.randrange(30_000, 60_000)}" for axis in "XYZF")
    assert sim.command(f"M {places}") == ":A \r\n"
    sim.run(20 * MS)


def test_records_are_where_the_pins_were(reporting):
    """300 pulses at any phase and the line's own rate, all axes moving, the host never silent; none is lost."""
    sim, rng = reporting, random.Random(1)
    assert sim.command("TTL X=1") == ":A \r\n"
    zero = [round(sim.count(n)) for n in range(4)]
    origin = [int(float(text) * 4.5396 + (0.5 if float(text) >= 0 else -0.5))
              for text in sim.command("W X Y Z F").split()[1:]]
    zero = [count - named for count, named in zip(zero, origin)]
    move_all(sim, rng)
    sim.report_read()
    times = random_times(rng, sim.time_ps + 500 * US, 300, RECORD * FRAME_PS)
    pins = play(sim, times, lines=b"W X Y Z F\r/\rS X? Y?\r")
    sim.run(60 * MS)
    data, starts = sim.report_read_timed()
    wanted = [tuple(count - at for count, at in zip(pins.at(sample_after(time)), zero)) for time in times]
    records = list(binary(data))
    assert len(records) == len(wanted)
    off = {tuple(a - b for a, b in zip(got, want)) for got, want in zip(records, wanted)}
    assert off == {(0, 0, 0, 0)}, off
    assert all(len({want[axis] for want in wanted}) > 200 for axis in range(4))
    assert {sample_after(time) % 4 for time in times} == {0, 1, 2, 3}
    assert sim.report_framing_errors == 0


def test_the_first_byte_follows_the_latch_at_once(reporting):
    """t_s of the original is 110 to 500 us.  60 pulses while axes move and the host asks; and 20 at rest."""
    sim, rng = reporting, random.Random(2)
    assert sim.command("TTL X=1") == ":A \r\n"
    figures = {}
    for name, lines, count in ("at rest", b"", 20), ("all axes moving, host asking", b"W X Y Z F\rM?\r", 60):
        if lines:
            move_all(sim, rng)
        sim.report_read()
        begin = sim.time_ps + 500 * US
        times = [begin + n * 2_500 * US + rng.randrange(400 * US) for n in range(count)]
        play(sim, times, lines=lines)
        _, starts = sim.report_read_timed()
        assert len(starts) == count * RECORD
        waits = [(start - (sample_after(time) + LATCH) * FAST_PERIOD_PS) / SYNC_PERIOD_PS
                 for start, time in zip(starts[::RECORD], times)]
        whole = [(last + FRAME_PS - first) / US for first, last in zip(starts[::RECORD], starts[RECORD - 1::RECORD])]
        figures[name] = min(waits), max(waits)
        print(f"{name}: last latch to first byte {min(waits):.0f} to {max(waits):.0f} sync clocks "
              f"({min(waits) / 50:.1f} to {max(waits) / 50:.1f} us); a record takes {min(whole):.0f} to {max(whole):.0f} us")
        assert max(whole) < 1.01 * RECORD * FRAME_PS / US
    assert max(most for _, most in figures.values()) < 110 * 50


def test_pulses_may_follow_each_other_within_a_microsecond(reporting):
    """20 pulses of 105 ns with pauses of 105 ns: 8000 times the rate that the original allows, until the queue is full."""
    sim = reporting
    assert sim.command("TTL M=2 X=1") == ":A \r\n"
    begin = sim.time_ps + 100 * US
    times = [begin + n * 210_000 for n in range(20)]
    play(sim, times, length_ps=105_000)
    sim.run(60 * MS)
    data = sim.report_read()
    records = [data[at:at + 31] for at in range(0, len(data), 31)]
    assert len(records) == 20 and all(binascii.crc_hqx(record, 0xffff) == 0 for record in records)
    stamps = [struct.unpack("<Q", record[5:13])[0] for record in records]
    assert [b - a for a, b in zip(stamps, stamps[1:])] == \
           [sample_after(b) - sample_after(a) for a, b in zip(times, times[1:])]
    assert sim.command("TREP R?") == ":A R=0\r\n"


@pytest.mark.parametrize("dip, baud", [(0, 115200), (3, 9600)])
def test_the_port_has_the_rate_of_the_main_port(built, dip, baud):
    with built.power_up(baud=baud) as sim:
        sim.set_dip(dip)
        sim.run(20 * MS)
        assert sim.command("BU F=3") == ":A \r\n"
        assert sim.command("TTL M=1 X=6") == ":A \r\n"
        sim.schedule_input(sim.time_ps + US, "in0", 1)
        sim.schedule_input(sim.time_ps + 2 * US, "in0", 0)
        sim.run(60 * MS)
        line = sim.report_read()
        assert line.startswith(b"X=") and line.endswith(b"\r\n") and line.count(b" ") == 3
        assert sim.report_framing_errors == 0


def test_a_megabaud(reporting):
    sim, rng = reporting, random.Random(3)
    assert sim.command("TREP Y=1000000") == ":A \r\n"
    assert sim.command("TTL X=1") == ":A \r\n"
    sim.report_set_baud(1e6)
    move_all(sim, rng)
    sim.report_read()
    times = random_times(rng, sim.time_ps + 500 * US, 200, RECORD * 10 * US)
    play(sim, times)
    assert len(list(binary(sim.report_read()))) == 200 and sim.report_framing_errors == 0


@pytest.mark.parametrize("baud, format_", [(115200, 0), pytest.param(115200, 1, marks=pytest.mark.slow), (1_000_000, 2)])
def test_records_cost_neither_ticks_nor_replies(reporting, baud, format_):
    """Records as fast as the line carries them, all axes moving: the servo's tick and WHERE keep their bounds."""
    sim, rng = reporting, random.Random(4)
    assert sim.command(f"TREP Y={baud}") == ":A \r\n"
    assert sim.command(f"TTL M={format_} X=1") == ":A \r\n"
    sim.report_set_baud(baud)
    move_all(sim, rng)
    sim.report_read()
    begin, pulses = sim.time_ps, (60 if baud < 1e6 else 300)
    size = {0: RECORD, 1: 40, 2: 31}[format_]
    for n in range(pulses):
        time_ps = begin + n * size * 10 * S // baud
        sim.schedule_input(time_ps, "in0", 1)
        sim.schedule_input(time_ps + US, "in0", 0)
    took_us = []
    while sim.time_ps < begin + pulses * size * 10 * S // baud:
        sim.run(rng.randrange(300, 1800) * US)
        took_us.append(reply_us(sim, "W X"))
    longest = tick_clocks(sim)[1]
    print(f"format {format_} at {baud} bit/s, line full: W X {min(took_us):.0f} to {max(took_us):.0f} us, longest servo "
          f"interrupt {longest} clocks of {PERIOD_CLOCKS}")
    assert len(sim.report_read()) > 0.9 * pulses * size * (0.7 if format_ == 1 else 1)
    assert max(took_us) < 500 and longest <= PERIOD_CLOCKS * 6 // 10
    assert not log_has(sim, "48") and not log_has(sim, "87")


def test_a_record_takes_the_processor_few_clocks(reporting):
    """Clocks awake for 8 pulses, less those of the same pulses when they mean nothing.

    They hang on where the linker puts what they run: 1,750 to 2,800 measured.
    """
    sim, cost = reporting, {}

    def awake(pulses):
        begin, before = sim.time_ps, sim.clocks[1]
        for n in range(pulses):
            time_ps = begin + (n * 3_013 + 100) * US
            sim.schedule_input(time_ps, "in0", 1)
            sim.schedule_input(time_ps + US, "in0", 0)
        sim.run(25 * MS)
        return sim.clocks[1] - before

    for line in "TTL X=0", "TTL M=0 X=1", "TTL M=1", "TTL M=2":
        assert sim.command(line) == ":A \r\n"
        sim.run(20 * MS)
        cost[line] = awake(0), (awake(8) - awake(0)) / 8
    nothing = cost.pop("TTL X=0")
    for line, (idle, pulse) in cost.items():
        print(f"{line}: {pulse - nothing[1]:.0f} clocks a record, {(idle - nothing[0]) / 25:.0f} a millisecond without any")
        assert 200 < pulse - nothing[1] < 4000 and idle - nothing[0] < 25 * 1000


def test_pulses_at_out0_send_packets(powered):
    """TTL Y=2: a pulse as a move ends; the packet has the place where it ended."""
    sim = powered
    for line in "RT Y=5", "TTL Y=2", "TREP F=1":
        assert sim.command(line) == ":A \r\n"
    sim.report_read()
    assert sim.command("M X=500") == ":A \r\n"
    sim.run_until_pin("out0", 1, timeout_ps=1 * S)
    sim.run(10 * MS)
    packet = sim.report_read()
    words = struct.unpack(f">{len(packet) // 2}H", packet)
    total = sum(words)
    while total > 0xffff:
        total = (total & 0xffff) + (total >> 16)
    assert len(packet) == 24 and words[:3] == (0, 0, 0) and total == 0xffff
    counts = struct.unpack(">4i", packet[6:22])
    assert counts[0] == pytest.approx(0.05 * 45396, abs=3) and all(abs(count) < 10 for count in counts[1:])


def test_the_example_of_the_manual(powered):
    """docs/modules/ttl_report.md: its lines and its bytes."""
    page = (toolchain.ROOT / "docs" / "modules" / "ttl_report.md").read_text().partition("## Example")[2]
    *lines, record = [line.strip() for line in page.splitlines() if line.startswith("    ")]
    for line in lines:
        assert powered.command(line) == ":A \r\n"
    powered.schedule_input(powered.time_ps + 1 * US, "in0", 1)
    powered.schedule_input(powered.time_ps + 2 * US, "in0", 0)
    powered.run(10 * MS)
    assert powered.report_read() == bytes.fromhex(record)
