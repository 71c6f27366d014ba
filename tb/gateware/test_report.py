# SPDX-License-Identifier: BSD-2-Clause
"""soc/gateware_report.py and gateware_seeds.py: figures out of a report of nextpnr that can be worked out by hand."""

import copy

import pytest

from soc import gateware_report as reporting
from soc import gateware_seeds

FAST, SYNC, BOARD = "x.gate.o", "clk", "$glbnet$clk50$TRELLIS_IO_IN"


def steps(*entries):
    """A path of ``(type, delay, cell)``; each step goes from the cell before to its own."""
    result, last = [], entries[0][2]
    for kind, delay, cell in entries:
        result.append({"type": kind, "delay": delay, "from": {"cell": last}, "to": {"cell": cell}})
        last = cell
    return result


REPORT = {
    "fmax": {FAST: {"achieved": 250.0, "constraint": 200.0}, SYNC: {"achieved": 40.0, "constraint": 50.0},
             BOARD: {"achieved": 300.0, "constraint": 50.0}},
    "utilization": {"TRELLIS_COMB": {"used": 10, "available": 100}, "TRELLIS_FF": {"used": 20, "available": 200},
                    "DP16KD": {"used": 3, "available": 30}, "MULT18X18D": {"used": 4, "available": 40},
                    "TRELLIS_IO": {"used": 50, "available": 60}},
    "critical_paths": [
        {"from": f"posedge {FAST}", "to": f"posedge {FAST}", "path": steps(
            ("clk-to-q", 0.5, "controller.line.command_TRELLIS_FF_Q_123"),
            ("routing", 1.25, "controller.line.line.divider.pixels.$signal$6_TRELLIS_FF_Q_DI_LUT4_Z"),
            ("logic", 0.25, "controller.line.line.divider.pixels.$signal$6_TRELLIS_FF_Q_DI_LUT4_Z"),
            ("routing", 2.0, "controller.pwm$319.left_CCU2C_A0$CCU2_COMB0"),
            ("setup", 0.0, "controller.pwm$319.left_CCU2C_A0$CCU2_COMB0"))},
        {"from": f"posedge {SYNC}", "to": f"posedge {SYNC}", "path": steps(("clk-to-q", 25.0, "a_TRELLIS_FF_Q"))},
        {"from": f"posedge {SYNC}", "to": f"posedge {FAST}", "path": steps(("clk-to-q", 0.5, "a"), ("routing", 1.5, "b"))},
        {"from": f"posedge {FAST}", "to": f"posedge {SYNC}", "path": steps(("clk-to-q", 0.5, "a"), ("routing", 3.5, "b"))},
        {"from": f"posedge {BOARD}", "to": f"posedge {FAST}", "path": steps(("clk-to-q", 0.5, "a"), ("routing", 9.0, "b"))},
        {"from": "<async>", "to": f"posedge {FAST}", "path": steps(("source", 0.0, "a$tr_io"), ("routing", 2.5, "b"))},
        {"from": "<async>", "to": "<async>", "path": steps(("source", 0.0, "a"), ("routing", 10.0, "b"))},
    ],
}


def test_use_counts_places_of_the_chip():
    assert reporting.use(REPORT) == {
        "lut4": {"used": 10, "available": 100}, "ff": {"used": 20, "available": 200},
        "ebr": {"used": 3, "available": 30}, "dsp": {"used": 4, "available": 40}}


def test_frequencies_are_those_of_our_domains():
    assert reporting.frequencies(REPORT) == {"fast": (250.0, 200.0), "sync": (40.0, 50.0)}


@pytest.mark.parametrize("constraint", [100.0, 199.0, 0.0])
def test_a_clock_that_nobody_asked_for_is_an_error(constraint):
    wrong = copy.deepcopy(REPORT)
    wrong["fmax"][FAST]["constraint"] = constraint
    with pytest.raises(ValueError, match="expected clocks"):
        reporting.frequencies(wrong)


def test_crossings_are_between_our_domains_only():
    assert reporting.crossings_ns(REPORT) == {"fast to sync": 4.0, "sync to fast": 2.0}
    assert reporting.pins_ns(REPORT) == {"pins to fast": 2.5}


def test_the_worst_path_is_told_in_parts_of_the_design():
    assert reporting.path(REPORT, "fast") == {
        "delay_ns": 4.0, "logic_ns": 0.75, "routing_ns": 3.25, "levels": 1,
        "through": ["line.command", "line.line.divider.pixels", "pwm.left"]}


@pytest.mark.parametrize("cell, name", [
    ("controller.memory.ram.words.0.12", "memory.ram"),
    ("controller.memory.ram.words.0.12_DOA0_LUT4_C", "memory.ram"),
    ("controller.cpu.core.dBus_cmd_payload_size_LUT4_Z_3", "cpu.core.dBus_cmd_payload_size"),
    ("controller.quadrature0.decoder$12.count_TRELLIS_FF_Q", "quadrature0.decoder.count"),
    ("clocks.sequencer.reset_TRELLIS_FF_Q", "clocks.sequencer.reset"),
])
def test_a_cell_belongs_to(cell, name):
    assert reporting.part(cell) == name


def seed(number, fast_mhz, sync_mhz):
    return {"seed": number, "fmax_mhz": {"fast": fast_mhz, "sync": sync_mhz}, "wanted_mhz": {"fast": 200.0, "sync": 50.0},
            "slack_ns": {"fast": 5 - 1000 / fast_mhz, "sync": 20 - 1000 / sync_mhz}, "crossing_ns_max": 3.0,
            "crossings_ns": {"sync to fast": 1.0, "fast to sync": 3.0}}


@pytest.mark.parametrize("way, longest", [("sync to fast", 10), ("fast to sync", 40)])
def test_a_crossing_longer_than_its_payload_is_still_is_a_miss(way, longest):
    """Two clocks of the reader: 5 ns or 20 ns each."""
    for ns, missed in (longest - 0.01, []), (longest, [way]):
        assert reporting.missed(report := seed(1, 210.0, 60.0) | {"crossings_ns": {way: ns}}) == missed
        assert ("MISSED" in gateware_seeds.table([report])) == bool(missed)


def test_the_table_of_seeds_names_the_one_that_misses():
    reports = [seed(1, 210.0, 60.0), seed(2, 198.0, 70.0), seed(3, 220.0, 55.0)]
    assert [reporting.missed(r) for r in reports] == [[], ["fast"], []]
    table = gateware_seeds.table(reports).splitlines()
    assert [line.split()[0] for line in table if "MISSED" in line] == ["2"]
    assert table[-2:] == ["fast: at least 198.0 MHz of 200, -1.0 %", "sync: at least 55.0 MHz of 50, +10.0 %"]
