# SPDX-License-Identifier: BSD-2-Clause
"""The virtual controller as a host sees it: its ports, its pace, its end, and what it costs."""

import os
import signal
import subprocess
import sys
import time

import pytest
import serial

from tb import toolchain
from tb.twin.__main__ import main
from tb.twin.twin import Twin


def ask(line, command):
    """Send a command, return its reply without the end of the line."""
    line.write(command.encode() + b"\r")
    reply = line.read_until(b"\n")
    assert reply.endswith(b"\r\n"), (command, reply)
    return reply[:-2].decode()


def wait(line, *, limit_s=20):
    """Poll until nothing is busy; the seconds that took."""
    began = time.monotonic()
    while ask(line, "/") != "N":
        assert time.monotonic() - began < limit_s
    return time.monotonic() - began


def processor_s(pid):
    """Processor time of a process so far."""
    fields = open(f"/proc/{pid}/stat").read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@pytest.fixture(scope="module")
def twin():
    with Twin() as running:
        yield running


@pytest.fixture
def line(twin):
    with serial.Serial(twin.port, 115200, timeout=5) as port:
        yield port


def test_it_moves_and_says_so(line):
    assert ask(line, "M X=12340").rstrip() == ":A"
    assert ask(line, "/") == "B"
    wait(line)
    assert float(ask(line, "W X").split()[1]) == pytest.approx(12340, abs=0.35)     # a count and the rounding


def test_time_passes_as_it_does(line):
    """A millimetre at 0.5 mm/s takes two seconds, on this clock as on the controller's."""
    ask(line, "H X=0")
    before = ask(line, "S X?").partition("=")[2]
    ask(line, "S X=0.5")
    ask(line, "M X=10000")
    took_s = wait(line)
    ask(line, f"S X={before}")
    assert 1.95 < took_s < 2.6


def test_a_joystick_in_the_middle_reads_half_of_its_range(line):
    """The converter, behind words instead of pins."""
    assert ask(line, "RA X Y").rstrip() == ":A 128 128"


def test_both_ports_are_the_same_line(twin, line):
    with serial.serial_for_url(twin.url, timeout=5) as remote:
        assert ask(remote, "W X") == ask(line, "W X")
        assert remote.read_until(b"\n").startswith(b":A")       # the other's answer is heard here too


def test_hosts_come_and_go(twin):
    for _ in range(3):
        with serial.serial_for_url(twin.url, timeout=5) as remote:
            assert ask(remote, "/") == "N"


def test_an_idle_controller_takes_little_of_the_processor(twin, line):
    wait(line)
    time.sleep(0.5)
    before, began = processor_s(twin.process.pid), time.monotonic()
    time.sleep(3)
    share = (processor_s(twin.process.pid) - before) / (time.monotonic() - began)
    print(f"idle: {100 * share:.1f} % of a processor")
    assert share < 0.15


def test_it_can_run_faster_than_real_time():
    with Twin(speed=10) as twin, serial.Serial(twin.port, timeout=5) as line:
        ask(line, "S X=0.5")
        ask(line, "M X=20000")
        assert wait(line) < 2               # 4 s of the controller's


def test_settings_survive_in_their_file(tmp_path):
    path = tmp_path / "settings"
    with Twin(settings=path) as twin, serial.Serial(twin.port, timeout=5) as line:
        ask(line, "S X=1.25")
        assert ask(line, "SS Z").startswith(":")
        time.sleep(0.5)
    with Twin(settings=path) as twin, serial.Serial(twin.port, timeout=5) as line:
        assert float(ask(line, "S X?").partition("=")[2]) == 1.25


def test_settings_live_in_the_flash_and_a_signal_is_a_power_cut(tmp_path):
    path = tmp_path / "flash"
    for speed in 1.25, 2.5:
        with Twin(flash=path, speed=10) as twin, serial.Serial(twin.port, timeout=5) as line:
            if speed != 1.25:
                assert float(ask(line, "S X?").partition("=")[2]) == 1.25
            ask(line, f"S X={speed}")
            assert ask(line, "SS Z").startswith(":")
            time.sleep(0.5)
    contents = path.read_bytes()
    assert len(contents) == 1 << 24 and b"littlefs" in contents[0x50_0000:0x54_0000]
    assert set(contents[:0x50_0000] + contents[0x54_0000:]) == {0xff}
    with Twin(flash=path, speed=10) as twin, serial.Serial(twin.port, timeout=5) as line:
        ask(line, "S X=3.5")
        ask(line, "SS Z")       # and no time to keep it
        twin.process.kill()
    with Twin(flash=path) as twin, serial.Serial(twin.port, timeout=5) as line:
        assert float(ask(line, "S X?").partition("=")[2]) in (2.5, 3.5)


def test_it_regulates_while_it_writes_to_the_flash(tmp_path):
    with Twin(flash=tmp_path / "flash") as twin, serial.Serial(twin.port, timeout=5) as line:
        ask(line, "M X=20000")
        for _ in range(3):
            assert ask(line, "SS Z").startswith(":")
        wait(line)
        assert float(ask(line, "W X").split()[1]) == pytest.approx(20000, abs=0.35)
        assert ask(line, "RS X").rstrip().startswith(":A")


def test_a_file_that_is_no_flash_is_refused(tmp_path):
    (tmp_path / "flash").write_text("other")
    done = subprocess.run([sys.executable, "-m", "tb.twin", "--flash", tmp_path / "flash"], cwd=toolchain.ROOT,
                          capture_output=True, text=True)
    assert done.returncode == 2 and "could not run: " in done.stderr and "not a flash's contents" in done.stderr
    assert (tmp_path / "flash").read_text() == "other"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_make_twin_cleanly(number):
    """Also while it moves; and its first lines are those that programs look for."""
    process = subprocess.Popen([sys.executable, "-m", "tb.twin", "--speed", "2"], cwd=toolchain.ROOT,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    first, second, third, fourth = (process.stdout.readline() for _ in range(4))
    assert first.startswith("serial port: /dev/") and second.startswith("tcp port: ")
    assert third.startswith("report port: /dev/") and fourth.startswith("report tcp port: ")
    with serial.Serial(first.removeprefix("serial port: ").strip(), timeout=5) as line:
        ask(line, "M X=100000")
        process.send_signal(number)
        assert process.wait(timeout=5) == 0
    assert process.communicate() == ("", "")


@pytest.mark.parametrize("options, said", [
    (["--plant", "colour=3"], "not 'colour=3'"),
    (["--speed", "0"], "--speed: expected a number above 0, not 0"),
    (["--tcp-port", "65536"], "expected 0 to 65535, not 65536"),
])
def test_senseless_options_are_refused_in_one_sentence(capsys, options, said):
    with pytest.raises(SystemExit) as refused:
        main(options)
    error = capsys.readouterr().err
    assert refused.value.code == 2
    assert error.startswith("error: ") and said in error and error.count("\n") == 1


def test_a_plant_that_the_board_does_not_take_is_said():
    done = subprocess.run([sys.executable, "-m", "tb.twin", "counts_per_mm=0"], cwd=toolchain.ROOT,
                          capture_output=True, text=True)
    assert done.returncode == 2 and "could not run: expected" in done.stderr
