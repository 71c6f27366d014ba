# SPDX-License-Identifier: BSD-2-Clause
"""The event-driven model of the peripherals against the Verilated gateware, clock by clock."""

import os
import re
import subprocess

import pytest

from tb.twin import gateware

ACCESSES = 1_000_000

CONSTANT = {f"identity.{name}.value" for name in ("magic", "map_version", "build_id", "clock_hz", "fast_clock_hz")}
UNREACHABLE = {"adc.events.overrun",        # a scan is shorter than a PWM period, so than any servo period
               *(f"report.{field}" for field in (   # the port hears nothing
                   "data.byte", "data.valid", "status.rx_ready", "errors.rx_overrun", "errors.framing",
                   "errors.line_break", "error_count.frames"))}
RARE = {"interlock.causes.watchdog"}    # set for one clock
PINS = ("pwm", "dir", "motor_enable", "out0", "sync_out", "encoder_out", "serial_tx", "adc_cs_n", "adc_sck", "adc_mosi",
        "report_tx", "flash_cs_n", "flash_sck", "flash_mosi", "report", "trigger", "tick", "serial", "timer", "line", "bus")


@pytest.fixture(scope="module")
def lockstep():
    """``lockstep(accesses, what, name)`` runs the comparison, broken if so asked; returns status and output."""
    program, table = gateware.build()
    seed = os.environ.get("SEED", "1")

    def run(accesses, *broken):
        done = subprocess.run([program, table, seed, str(accesses), *broken], capture_output=True, text=True)
        assert not done.stderr, done.stderr
        return done.returncode, done.stdout
    print(f"seed {seed}")
    return run


def test_a_million_accesses_agree_and_toggle_every_field(lockstep):
    status, said = lockstep(ACCESSES)
    assert status == 0, said
    print(*re.findall("^(?!toggled).*", said, re.MULTILINE), sep="\n")
    assert int(re.search(r"^pin events (\d+)$", said, re.MULTILINE)[1]) > 1_000_000
    assert int(re.search(r"^pin changes (\d+)$", said, re.MULTILINE)[1]) > 100_000
    rows = re.findall(r"^toggled (\S+) (\S+) (\d+) (\d+)$", said, re.MULTILINE)
    assert len(rows) == len(gateware.fields())
    assert {name for name, _access, bits, _width in rows if bits == "0"} - RARE == CONSTANT | UNREACHABLE
    # What firmware writes, in every bit; of what hardware counts the upper bits take hours.
    assert [row for row in rows if row[1] != "R" and row[2] != row[3] and row[0] not in UNREACHABLE] == []


@pytest.mark.parametrize("block", sorted({name.partition(".")[0] for name, *_ in gateware.fields()}))
def test_a_field_that_reads_wrong_is_found(lockstep, block):
    for name, _address, _shift, _width, access in gateware.fields():
        if name.startswith(block + ".") and access != "W":
            status, said = lockstep(100_000, "read", name)
            assert status == 1 and f" {name} reads " in said, (name, said[-200:])


def test_a_field_that_is_written_wrong_is_found(lockstep):
    for name, _address, _shift, _width, access in gateware.fields():
        if access in ("RW", "W"):
            status, said = lockstep(100_000, "write", name)
            assert status == 1, name


@pytest.mark.parametrize("pin", PINS)
def test_a_pin_that_is_a_clock_late_is_found(lockstep, pin):
    status, said = lockstep(100_000, "pin", pin)
    assert status == 1 and f": {pin} changes in the " in said, said[-200:]
