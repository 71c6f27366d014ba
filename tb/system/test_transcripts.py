# SPDX-License-Identifier: BSD-2-Clause
"""Transcripts on the real firmware in the real gateware: some here, all of them in ``make test-slow`` (``FULL_LINES=1``)."""

import os

import pytest

from tb.sim.serial_port import SerialPort
from tb.transcripts.runner import VECTORS, Host, Session

FULL = "FULL_LINES" in os.environ
SOME = ("identity", "client_sessions", "ttl_ring_zstack")
FILES = sorted(path.stem for path in VECTORS.glob("*.txt")) if FULL else SOME


@pytest.mark.parametrize("name", FILES)
def test_the_controller_says_what_the_transcript_says(powered, name):
    port = SerialPort(powered)
    session = Session(Host(port, patience=0.2, clock=port.clock))
    session.run(VECTORS / f"{name}.txt")
    assert not session.result.failures, "\n".join(session.result.failures)
    assert session.result.passed > 0 or session.result.deferred
