# SPDX-License-Identifier: BSD-2-Clause
"""The virtual controller's boot program, and a scripted update with the ``smpmgr`` of PyPI, unmodified."""

import contextlib
import re
import time

import pytest
import serial

from tb import toolchain
from tb.boot.test_update import hash_of, smpmgr
from tb.firmware.host import build
from tb.twin.test_twin import ask, wait
from tb.twin.twin import Twin

CONFIRM_S = 10      # of UPDATE_CONFIRM_S, and some more


@pytest.fixture(scope="module")
def images():
    build("host/images/made")
    return toolchain.BUILD / "host" / "images"


def states(port):
    """``[(slot, version, active, confirmed)]`` as ``smpmgr image state-read`` lists them."""
    listed = smpmgr(port, "image", "state-read")
    found = re.findall(r"slot=(\d),\s*version='([\d.]+)'.*?confirmed=(\w+),\s*active=(\w+)", listed, re.DOTALL)
    return [(int(slot), version, active == "True", confirmed == "True") for slot, version, confirmed, active in found]


def to_update_server(port):
    with serial.Serial(port, 115200, timeout=5) as line:
        assert ask(line, "BU R=1").rstrip() == ":A"
    time.sleep(0.2)


def from_update_server(port):
    """Reset, and the application that is then there."""
    smpmgr(port, "os", "reset")
    time.sleep(0.3)
    line = serial.Serial(port, 115200, timeout=5)
    line.reset_input_buffer()
    assert ask(line, "/") == "N"
    return line


def test_smpmgr_updates_the_virtual_controller(tmp_path, images):
    flash, good, newer = tmp_path / "flash", images / "good.bin", images / "newer.bin"
    with Twin(flash=flash, speed=4) as twin:
        with serial.Serial(twin.port, timeout=5) as line:
            ask(line, "S X=1.25")
            assert ask(line, "SS Z").startswith(":")
            ask(line, "M X=5000")
            wait(line)
            time.sleep(0.3)
        to_update_server(twin.port)
        smpmgr(twin.port, "image", "upload", good)
        smpmgr(twin.port, "image", "state-write", hash_of(good), "--confirm")
        with from_update_server(twin.port) as line:
            assert float(ask(line, "S X?").partition("=")[2]) == 1.25       # the settings are where they were
            assert ask(line, "BU X").strip()
        to_update_server(twin.port)
        assert states(twin.port) == [(0, "1.0.0", True, True)]
        smpmgr(twin.port, "image", "upload", newer)
        assert [row[:2] for row in states(twin.port)] == [(0, "1.0.0"), (1, "1.0.1.7")]
        smpmgr(twin.port, "image", "state-write", hash_of(newer))
        from_update_server(twin.port).close()
        to_update_server(twin.port)
        assert states(twin.port) == [(0, "1.0.0", False, True), (1, "1.0.1.7", True, False)]
    with Twin(flash=flash, speed=4) as twin:        # not confirmed: reverted
        to_update_server(twin.port)
        assert [row[2] for row in states(twin.port)] == [True, False]
        smpmgr(twin.port, "image", "state-write", hash_of(newer))
        from_update_server(twin.port).close()
        time.sleep(CONFIRM_S / 4 + 1)               # the application finds itself well
    with Twin(flash=flash, speed=4) as twin:
        to_update_server(twin.port)
        assert states(twin.port) == [(1, "1.0.1.7", True, True)]     # and the older one is not one any more


def test_what_is_not_signed_with_the_key_is_refused(tmp_path, images):
    with Twin(flash=tmp_path / "flash") as twin:
        to_update_server(twin.port)
        assert "image signed with another key" in smpmgr(twin.port, "image", "upload", images / "other-key.bin", fails=True)
        assert states(twin.port) == []


def test_the_program_begins_anew_after_a_reset(tmp_path, images):
    with Twin(flash=tmp_path / "flash", speed=4) as twin:
        to_update_server(twin.port)
        smpmgr(twin.port, "image", "upload", images / "good.bin")
        smpmgr(twin.port, "image", "state-write", hash_of(images / "good.bin"), "--confirm")
        with from_update_server(twin.port) as line:
            ask(line, "S X=3.25")           # not saved
        to_update_server(twin.port)
        with from_update_server(twin.port) as line:
            assert float(ask(line, "S X?").partition("=")[2]) != 3.25
            ask(line, "M X=3000")
            wait(line)
            assert float(ask(line, "W X").split()[1]) == pytest.approx(3000, abs=0.35)


def test_without_a_flash_a_reset_is_the_end():
    with Twin() as twin:
        with serial.Serial(twin.port, timeout=5) as line, contextlib.suppress(serial.SerialException):
            ask(line, "BU R=1")         # answered, unless the port has gone by then
        assert twin.process.wait(timeout=5) == 3
