# SPDX-License-Identifier: BSD-2-Clause
"""soc/programmer.py: what is sent to a board, what is not, and what is said when it fails."""

import hashlib
import json
import os
from types import SimpleNamespace

import pytest

from soc import gateware, programmer

BOARD = SimpleNamespace(name="made-up", programmer="ulx3s")


def write(directory, data=b"bits", **changes):
    (directory / "abbe.bit").write_bytes(data)
    report = {"bitstream_sha256": hashlib.sha256(b"bits").hexdigest(), "runs": True, "memory": "whole"} | changes
    (directory / "report.json").write_text(json.dumps(report))


def test_the_bitstream_sent_is_that_of_the_report(tmp_path):
    with pytest.raises(SystemExit, match="make gateware BOARD=made-up"):
        programmer.bitstream(BOARD, tmp_path)
    write(tmp_path)
    assert programmer.bitstream(BOARD, tmp_path) == tmp_path / "abbe.bit"
    write(tmp_path, data=b"others")
    with pytest.raises(SystemExit, match="is not that of report.json"):
        programmer.bitstream(BOARD, tmp_path)
    write(tmp_path, runs=False, memory="too little of it")
    with pytest.raises(SystemExit, match="not sent: too little of it"):
        programmer.bitstream(BOARD, tmp_path)


@pytest.mark.parametrize("name, programmer_name, said", [
    ("ulx3s-25f", "ulx3s", "256 KiB of RAM and there are 16"), ("ulx3s-85f", None, "does not know the board ulx3s-85f")])
def test_a_board_that_can_never_be_sent_to_is_refused_before_anything_is_built(monkeypatch, name, programmer_name, said):
    monkeypatch.setattr(gateware.board(name), "programmer", programmer_name)
    monkeypatch.setattr(programmer, "bitstream", lambda *arguments: pytest.fail("looked for a bitstream"))
    for way in "check", "flash", "program":
        monkeypatch.setattr("sys.argv", ["programmer", name, way])
        with pytest.raises(SystemExit, match=said):
            programmer.main()


def test_the_product_passes_the_check_that_sends_nothing(monkeypatch):
    monkeypatch.setattr(programmer.subprocess, "run", lambda *arguments, **options: pytest.fail("sent"))
    monkeypatch.setattr("sys.argv", ["programmer", "ulx3s-85f", "check"])
    programmer.main()


@pytest.mark.parametrize("said, sentence", [
    ("unable to open ftdi device: -3 (device not found)\nJTAG init failed", "no board was found"),
    ("unable to open ftdi device: -4 (usb_open() failed)", "udev rule"),
    ("unable to open ftdi device: -8 (unable to claim USB device...)", "another program holds the board"),
    ("something new", "what it said is above"),
])
def test_a_failure_is_explained(said, sentence):
    assert sentence in programmer.explain(said)


@pytest.mark.parametrize("way, options", [("flash", ["--write-flash", "--verify"]), ("program", ["--write-sram"])])
def test_openfpgaloader_is_called_and_its_failure_passed_on(tmp_path, monkeypatch, way, options):
    tool, directory = tmp_path / "openFPGALoader", tmp_path / "ulx3s-85f"
    tool.write_text('#!/bin/sh\n[ "$1" = --Version ] && { echo openFPGALoader v0.10.0; exit; }\n'
                    f'echo "$@" > {tmp_path}/called\ncat {tmp_path}/said >&2; exit $(cat {tmp_path}/status)\n')
    tool.chmod(0o755)
    directory.mkdir()
    write(directory)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setattr(programmer.toolchain, "BUILD", tmp_path)
    monkeypatch.setattr("sys.argv", ["programmer", "ulx3s-85f", way])
    (tmp_path / "said").write_text("")
    (tmp_path / "status").write_text("0")
    programmer.main()
    assert (tmp_path / "called").read_text().split() == ["--board", "ulx3s", *options, str(directory / "abbe.bit")]
    (tmp_path / "said").write_text("unable to open ftdi device: -3 (device not found)")
    (tmp_path / "status").write_text("1")
    with pytest.raises(SystemExit, match="ulx3s-85f: no board was found"):
        programmer.main()
