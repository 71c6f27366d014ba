# SPDX-License-Identifier: BSD-2-Clause
"""The command page says what the rows say."""

from firmware.manual.commands import render, rows

COMMAND = {"name": "GRAIN", "shortcut": "G", "summary": "Size | of grains.", "letters": "", "form": 1, "flags": 0,
           "accepts": 0, "own_letters": False, "runs": False}
ROW = {"command": "GRAIN", "letter": "X", "unit": "um", "summary": "Size.", "integer": False, "decimals": 3,
       "decimals_max": 0, "minimum": -0.5, "maximum": 100, "taken": None, "below": 2, "above": 1, "saved": 1, "read_only": False,
       "asked": True, "signs": False, "initial": [50]}


def page(*parameters):
    return render([{"name": "sample", "commands": [COMMAND], "parameters": list(parameters)}])


def test_a_row_is_a_line():
    text = page(ROW)
    assert "| [GRAIN](#grain) | `G` | Size \\| of grains. |" in text
    assert "### GRAIN\n\nSize | of grains. Queries: `:X=1 Y=2 A`.\n" in text
    assert "| X | Size. | um | -0.5 (ignored) … 100 (clipped) | 50 | at once |" in text


def test_values_of_axes_that_differ_are_all_there():
    assert "| axis | Size. | um | -0.5 (ignored) … 100 (clipped) | 24, 25 | at once |" in \
        page({**ROW, "letter": "*", "initial": [24, 25, 24]})


def test_what_a_check_leaves_of_a_range_is_told():
    assert "| X | Size. | um | 0, 2 … 5 | 50 | at once |" in page({**ROW, "taken": "0, 2 ... 5"})
    assert "| X | Size. | um | – | 50 | at once |" in page({**ROW, "taken": ""})


def test_the_program_asks_the_checks():
    told = {(row["command"], row["letter"]): row["taken"] for module in rows() for row in module["parameters"]}
    assert told["VERSION", "Z"] == "48 ... 57, 97 ... 122"
    assert told["BCUSTOM", "X"] == "0, 2, 3"
    assert told["EPOLARITY", "*"] == "-1, 1"
    assert told["MOTCTRL", "*"] == ""
    assert told["JSSPD", "X"] == "-100 ... -0.1, 0.1 ... 100"
    assert told["SPEED", "*"] is None


def test_what_can_only_be_read_has_no_default():
    assert "| X | Size. | um | – | – | – |" in page({**ROW, "read_only": True})


def test_rows_that_cannot_be_typed_are_left_out():
    assert "| Letter |" not in page({**ROW, "letter": "1"})


def test_commands_without_queries_promise_no_form():
    assert "Queries" not in page({**ROW, "asked": False}).split("### GRAIN")[1].split("##")[0]
