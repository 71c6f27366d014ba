# SPDX-License-Identifier: BSD-2-Clause
"""soc/: a bare program on the Verilated SoC boots, reaches what it may, traps where it must, and sleeps exactly.

``program/program.c`` says what happens over the serial port; what should happen is written here.
"""

import re

import pytest

from rtl.identity import MAP_VERSION
from soc import verilog
from tb.soc import bench

CLOCKS = 950_000
DIVISOR = 8                     # set by the program
CLOCKS_PER_TICK = 4 * 2500
LOAD_ACCESS_FAULT, INSTRUCTION_ACCESS_FAULT = 5, 1


@pytest.fixture(scope="module")
def awake():
    return bench.run(CLOCKS)


@pytest.fixture(scope="module")
def said(awake):
    """``[(name, [numbers])]`` of the lines the program printed."""
    lines = bench.serial_text(awake[0], DIVISOR).splitlines()
    assert lines[-1] == "end"
    result = []
    for line in lines[:-1]:
        words = line.split()
        values = [int(word, 16) for word in words if re.fullmatch("[0-9a-f]{8}", word)]
        result.append((" ".join(words[:len(words) - len(values)]), values))
    return result


def numbers(said, name):
    return [values for key, values in said if key == name]


def test_boots_from_zero_and_the_identity_is_readable(said):
    assert numbers(said, "magic") == [[0x41626265]]
    assert numbers(said, "version") == [[MAP_VERSION, verilog.build_id()]]
    assert numbers(said, "clocks") == [[50_000_000, 200_000_000]]


def test_a_load_that_nobody_answers_traps(said):
    # Behind boot, behind RAM, cached and uncached nothing, a gap between registers, below the registers.
    addresses = 0x00008000, 0x00060000, 0x00400000, 0x90000000, 0xfffff7fc, 0xffffe000
    assert numbers(said, "load") == [[1, LOAD_ACCESS_FAULT, address] for address in addresses]


def test_a_register_is_read_by_whole_words_only(said):
    assert numbers(said, "load byte") == [[1, LOAD_ACCESS_FAULT, 0xfffff000]]
    assert numbers(said, "load half") == [[1, LOAD_ACCESS_FAULT, 0xfffff000]]


def test_a_jump_into_nothing_traps_and_leaves_the_cache_sound(said):
    assert numbers(said, "jump") == [[1, INSTRUCTION_ACCESS_FAULT, 0x00400000]]


def test_a_refused_store_interrupts_and_is_lost(said):
    # Boot region, nothing, a gap between registers: one interrupt each; then a byte into a register: also the
    # final "store" line, which reports traps and has seen none.
    refused = numbers(said, "store")
    assert [values[:3] for values in refused[:4]] == [
        [1, 1 << 4, address] for address in (0x00000000, 0x00400000, 0xfffff7fc, 0xfffff880)]
    assert refused[4] == [0, 0, 0]
    first_word = int(bench.build_program().read_text().split()[0], 16)
    assert numbers(said, "boot") == [[first_word, 1]]


def test_ram_keeps_bytes_halves_and_words_apart(said):
    assert numbers(said, "bytes") == [[0xbbccaa44]]
    assert numbers(said, "ram") == [[0]]


def test_code_written_to_ram_runs_after_fence_i(said):
    assert numbers(said, "run") == [[2 * 0x1234]]


@pytest.mark.parametrize("line", range(5))
def test_each_interrupt_line_reaches_the_handler(said, line):
    assert [line, 1 << line] in numbers(said, "line")


def test_a_byte_goes_out_and_comes_back(said):
    echo = [values for key, values in said if key.endswith("echo")]
    assert echo == [[0x100 | ord("U"), ord("U")]]       # valid the first time, empty the second


def test_bus_access_times(said):
    (loads, stores), = numbers(said, "bus")
    print(f"16 register loads in a row: {loads} clocks; 16 stores: {stores} clocks")
    # 2 clocks on the bus; the rest is the way through the processor's pipeline.
    assert 16 * 2 <= stores <= 16 * 4 and 16 * 2 <= loads <= 16 * 6


@pytest.mark.parametrize("work, most_allowed", [
    ("sleeping", 50), ("spinning", 25), ("dividing", 60), ("missing", 200)])
def test_interrupt_latency(said, work, most_allowed):
    (least, most), = numbers(said, f"latency {work}")
    print(f"timer alarm to the handler's first load, {work}: {least} to {most} clocks")
    assert 10 <= least <= most <= most_allowed


def test_asleep_from_tick_to_tick_every_handler_runs_on_time(said):
    assert numbers(said, "ticks") == [[CLOCKS_PER_TICK, CLOCKS_PER_TICK]]
    assert numbers(said, "overrun")[0][0] == 0


def test_stopping_the_clock_of_a_sleeping_processor_changes_nothing(awake):
    events, left_out = bench.run(CLOCKS, "--stop")
    print(f"left out {left_out} of {CLOCKS} processor clocks")
    assert awake[1] == 0
    assert left_out > 300_000                           # the program sleeps through most of its 64 ticks
    assert events == awake[0]
