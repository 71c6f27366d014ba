# SPDX-License-Identifier: BSD-2-Clause
"""The simulated controller behind a pty, as a serial library sees it. Runs around the stand-in of fixture.v."""

import os
import threading
import time

import pytest
import serial

from tb.sim.pty import Port, Stopwatch, main, parse, serve
from tb.sim.simulator import MS, Simulator
from tb.sim.test_simulator import FIXTURE, GREETING


@pytest.fixture
def port(tmp_path):
    """A served pty; the stand-in sends every byte back, plus one."""
    boot = tmp_path / "boot.hex"
    boot.write_text(f"{int.from_bytes(GREETING, 'little'):08x}\n0\n0\n0\n")
    end, over = Port(), threading.Event()
    with Simulator(boot=boot, verilog=FIXTURE) as sim:
        # Whoever opens a serial port throws away what waits there, the stand-in's greeting or not.
        sim.run(MS)
        assert sim.serial_read() == GREETING
        server = threading.Thread(target=serve, args=(
            sim, end, lambda: not over.is_set(), Stopwatch(sim, 0.2).look))
        server.start()
        try:
            yield end
        finally:
            over.set()
            server.join()
            end.close()


def test_a_serial_library_talks_to_it(port):
    with serial.Serial(port.path, 115200, timeout=20) as line:
        line.write(b"HAL\r")
        assert line.read(4) == b"IBM\x0e"


def test_it_survives_a_host_that_leaves_and_returns(port):
    for _ in range(3):
        with serial.Serial(port.path, 9600, timeout=20) as line:
            line.write(b"\x03")
            assert line.read_until(b"\x04").endswith(b"\x04")


def test_every_byte_value_passes_both_ways(port):
    sent = bytes(range(256))
    with serial.Serial(port.path, timeout=20) as line:
        for at in range(0, 256, 64):
            line.write(sent[at:at + 64])
            assert line.read(64) == bytes((byte + 1) % 256 for byte in sent[at:at + 64])


def test_it_says_how_fast_it_is(port, capfd):
    deadline = time.monotonic() + 20
    text = ""
    while "of real time" not in text and time.monotonic() < deadline:
        time.sleep(0.1)
        text += capfd.readouterr().err
    assert "simulated" in text and "at 1/" in text


def test_output_nobody_reads_does_not_stop_it():
    end = Port()
    try:
        for _ in range(100):
            end.write(bytes(4096))
        end.write(b"last")
        reader = os.open(end.path, os.O_RDONLY | os.O_NOCTTY | os.O_NONBLOCK)
        got = bytearray()
        while not got.endswith(b"last") and len(got) < 1 << 20:
            got += os.read(reader, 65536)
            end.write(b"")
        os.close(reader)
        assert got.endswith(b"last")
    finally:
        end.close()


@pytest.mark.parametrize("options, said", [
    (["--plant", "colour=3"], "not 'colour=3'"),
    (["x.running_friction=much"], "'x.running_friction=much': could not convert"),
    (["--baud", "0"], "--baud: expected a number above 0, not 0"),
    (["--report", "0"], "--report: expected a number above 0, not 0"),
])
def test_senseless_options_are_refused_in_one_sentence(capsys, options, said):
    with pytest.raises(SystemExit) as refused:
        main(options, build=None)
    error = capsys.readouterr().err
    assert refused.value.code == 2
    assert error.startswith("error: ") and said in error and error.count("\n") == 1


def test_a_recording_that_cannot_be_written_is_said_before_anything_is_built(tmp_path, capsys):
    assert main(["--vcd", str(tmp_path / "none" / "pins.vcd")], build=None) == 2
    assert "none/pins.vcd: No such file or directory" in capsys.readouterr().err


def test_a_plant_that_the_board_does_not_take_is_said(capsys):
    class Design:
        def power_up(self, **arguments):
            return Simulator(verilog=FIXTURE, **arguments)
    assert main(["--plant", "counts_per_mm=0"], build=lambda say: Design()) == 2
    assert "could not run: " in capsys.readouterr().err


def test_both_spellings_of_a_plant_parameter_are_taken():
    assert parse(["--plant", "x.running_friction=0.2", "speed_scale=0.5"]).plant == \
        ["x.running_friction=0.2", "speed_scale=0.5"]
