# SPDX-License-Identifier: BSD-2-Clause
"""The transcripts on the virtual controller, as they are and as other hosts would say them."""

import contextlib

import pytest
import serial

from tb.transcripts.__main__ import TWIN_SPEED
from tb.transcripts.runner import VECTORS, Host, Session
from tb.transcripts.transcript import Condition, Exchange, TranscriptError, glued, load, parse, variants, with_exponents
from tb.twin.twin import Twin

WAYS = {"plain": (), "mirrored": ("mirrored",), "exponents": ("exponents",), "glued": ("glued",),
        "doubled": ("doubled",), "all": ("mirrored", "exponents", "glued", "doubled")}


@pytest.mark.parametrize("names", WAYS.values(), ids=WAYS)
def test_the_controller_says_what_the_transcripts_say(names):
    with Twin(speed=TWIN_SPEED) as twin, serial.Serial(twin.port) as port:
        session = Session(Host(port), names=names)
        for file in sorted(VECTORS.glob("*.txt")):
            session.run(file)
    assert not session.result.failures, "\n".join(session.result.failures)
    exchanges = sum(isinstance(step, Exchange) for file in VECTORS.glob("*.txt") for step in load(file))
    assert session.result.passed + len(session.result.deferred) == exchanges


@contextlib.contextmanager
def powered(settings=None):
    """A host at a controller just powered up."""
    with Twin(speed=TWIN_SPEED, settings=settings) as twin, serial.Serial(twin.port) as port:
        host = Host(port)
        host.wait_until_back()
        yield host


def test_settings_outlive_the_power_when_saved(tmp_path):
    file = tmp_path / "settings"
    with powered(file) as host:
        for line in "S X=1.25", "UM Y=-10000", "V X=5 Z=53", "BU Y=104", "SS Z", "S X=2.5":
            assert host.say(line) == ":A"
    with powered(file) as host:
        assert host.say("S X?") == ":A X=1.250000"
        assert host.say("UM Y?") == ":Y=-10000.000000 A"
        assert host.say("V") == ":A Version: USB-9.55"
        assert host.say("BU Y?") == ":A h"
        assert host.say("SS X") == ":A"
    with powered(file) as host:
        assert host.say("S X?") != ":A X=1.250000"
        assert host.say("SS Y") == ":A"
        assert host.say("S X?") == ":A X=1.250000"
    with powered(file) as host:
        assert host.say("S X?") == ":A X=1.250000"


def test_a_settings_file_that_is_damaged_or_cannot_be_written_does_no_harm(tmp_path):
    file = tmp_path / "settings"
    file.write_bytes(b"nonsense\n00000001 0x1p+zz\n\xff\xfe" + b"x" * 5000)
    with powered(file) as host:
        assert host.say("S X?").startswith(":A X=")
        assert host.say("DU Y").split()[0] == "55"                       # and says so
        assert host.say("SS Z") == ":A"
    with powered(file) as host:
        assert host.say("DU Y").split()[0] == "0"                        # the file is whole again
    with powered(tmp_path / "no" / "such" / "directory") as host:
        assert host.say("SS Z") == ":N-5"


def test_positions_and_limits_outlive_the_power_after_savepos(tmp_path):
    file = tmp_path / "settings"
    with powered(file) as host:
        for line in "SL X=-20", "H X=5000 Y=-123.4", "R X=100":
            assert host.say(line) == ":A"
        host.wait_until_idle()
        x, y = (float(number) for number in host.say("W X Y").split()[1:])
        low = float(host.say("SL X?").partition("=")[2])
        assert host.say("SP") == ":A"
        assert host.ask(b"W X\r/\r", silent=True) == b""             # deaf from here on
    with powered(file) as host:
        now_x, now_y = (float(number) for number in host.say("W X Y").split()[1:])
        assert abs(now_x - x) <= 0.3 and abs(now_y - y) <= 0.3       # to the encoder count
        assert abs(float(host.say("SL X?").partition("=")[2]) - low) <= 0.001
    with powered(file) as host:
        assert host.say("W X Y") == ":A 0.0 0.0"                     # they hold for one power-up


def test_a_reset_forgets_positions_and_keeps_what_was_saved():
    with powered() as host:
        for line in "S X=1.25", "SS Z", "S X=2.5", "H X=5000", "RESET":
            assert host.say(line) == ":A"
        host.wait_until_back()
        assert host.say("W X") == ":A 0.0"
        assert host.say("S X?") == ":A X=1.250000"


@pytest.mark.parametrize("scale", [None, "C X=90000"], ids=["", "with another scale"])
def test_a_reset_leaves_limits_and_home_where_they_are_on_the_stage(scale):
    with powered() as host:
        for line in "SL X=-2", "SU X=5", "HM X=4", "M X=30000":
            assert host.say(line) == ":A"
        host.wait_until_idle()
        for line in ([scale] if scale else []) + ["RESET"]:              # it stands at 3 mm, and forgets the scale
            assert host.say(line) == ":A"
        host.wait_until_back()
        assert [host.say(f"{name} X?") for name in ("SL", "SU", "HM")] == [":A X=-5.000", ":A X=2.000", ":A X=1.000"]
        assert host.say("M X=50000") == ":A"
        host.wait_until_idle()
        assert host.say("W X") == ":A 20000.0"


BURST = ("UM X=10000 Y=10000 Z=10000", "R X=0 Y=0 Z=10", "RT Y=0.1", "AC Z=10", "TTL X=2 Y=2 F=1", "PC Z=0.005", "E Z=0.0001")


def test_commands_may_come_before_their_replies():
    """The seven settings a laboratory writes before it reads, and a client's move and status back to back."""
    with powered() as host:
        replies = host.ask("".join(f"{line}\r" for line in BURST).encode(), complete=lambda r: r.count(b"\n") >= len(BURST))
        assert replies == b":A \r\n" * len(BURST)
        assert host.ask(b"M X=5000\r/ \r", complete=lambda r: r.count(b"\n") >= 2) == b":A \r\nB\r\n"


def test_a_kilobyte_of_commands_is_answered_one_by_one_and_in_order():
    lines = [f"BU Z={n}\rBU Z?" for n in range(70)]
    data = "".join(f"{line}\r" for line in lines).encode()
    with powered() as host:
        replies = host.ask(data, complete=lambda r: r.count(b"\n") >= 140)
    assert 900 < len(data) < 1024
    assert replies == b"".join(b":A \r\n:A %d\r\n" % n for n in range(70))


def test_a_client_that_tunes_at_its_start_gets_its_answers():
    """NAV's start-up: two CRs, one line read for each command, a second of patience."""
    with powered() as host:
        for axis in "XYZ":
            for line in f"AA {axis}=85", f"AZ {axis}":
                assert host.ask(f"{line}\r\r".encode()) == b":A \r\n"
        assert all(700 < float(gain.partition("=")[2]) < 900 for gain in host.say("KP X? Y? Z?").split()[1:])


def test_a_halt_ends_the_tuning_at_once():
    with powered() as host:
        host.say("KP X=700")
        replies = host.ask(b"AZ X\r\\", complete=lambda r: r.count(b"\n") >= 2)
        assert replies == b":N-5\r\n:N-21\r\n"
        assert host.say("/") == "N" and host.say("KP X?") == ":A X=700"


class Fake:
    """A port that answers each line from a table, CR LF added unless it has its own."""

    def __init__(self, answers):
        self._answers, self._waiting, self.sent = answers, b"", []

    timeout = 0

    @property
    def in_waiting(self):
        return len(self._waiting)

    def reset_input_buffer(self):
        self._waiting = b""

    def write(self, data):
        self.sent.append(data)
        self._waiting = self._answers.get(data.rstrip(b"\r"), b":A \r\n")

    def read(self, size=1):
        data, self._waiting = self._waiting[:size], self._waiting[size:]
        return data


def run(text, answers, tmp_path, **arguments):
    """A transcript against canned answers."""
    file = tmp_path / "t.txt"
    file.write_text(text)
    fake = Fake({b"/": b"N\r\n", b"MA X?": b":N-1\r\n", b"BU X": b"B\rMotor Axes: X Y  \r\n", **answers})
    session = Session(Host(fake, patience=0.05, quiet=0.001), **arguments)
    session.run(file)
    return session.result, fake.sent


@pytest.mark.parametrize("answer, good", [
    (b":A 1 \r\n", True), (b":A 1\r\n", True), (b":A 2\r\n", False), (b":A 1\r", False), (b"", False),
    (b":A 1\r\n:A\r\n", False), (b" :A 1\r\n", False), (b":A 1\rmore\r\n", False)])
def test_a_reply_is_judged_to_the_letter(answer, good, tmp_path):
    result, _ = run("> Q\n< :A 1\n", {b"Q": answer}, tmp_path)
    assert (result.passed, len(result.failures)) == (good, not good)


@pytest.mark.parametrize("text, good", [
    ("> Q\n~ :A \\d\n~ .*x\n", True), ("> Q\n~ :A\n~ .*x\n", False), ("> Q\n~ :A \\d\n", False),
    ("> Q\n~ :A \\d\n...\n", True), ("> Q\n= 3a 41 20 31 0d 20 78 0d 0a\n", True), ("> Q\n= 3a 41\n", False),
    ("> Q\n= nothing\n", False), ("> Q\n", False)])
def test_lines_patterns_bytes_and_silence(text, good, tmp_path):
    result, _ = run(text, {b"Q": b":A 1\r x\r\n"}, tmp_path)
    assert result.passed == good


def test_what_is_not_built_or_not_fitted_is_counted_and_not_run(tmp_path):
    text = "! module maintain\n> MA X?\n< :A X=0\n! module\n> Q\n< :A\n! axes Z\n> W Z\n< :A 0\n"
    result, sent = run(text, {}, tmp_path)
    assert (result.passed, result.deferred, result.inapplicable) == (1, [("t.txt:2", "maintain")], 1)
    assert b"W Z\r" not in sent


def test_a_condition_that_is_not_met_is_a_failure(tmp_path):
    result, _ = run("! send S X=1\n> Q\n< :A\n", {b"S X=1": b":N-4\r\n"}, tmp_path)
    assert result.passed == 1 and "S X=1" in result.failures[0]


def test_the_same_words_as_other_hosts_would_say_them():
    assert with_exponents("PC X=.5 Y=-12 Z?") == "PC X=5e-01 Y=-12e+00 Z?"
    assert glued("M X=1 Y=2 Z") == "M X=1Y=2Z"
    assert glued("TTL Y=9 40") == "TTL Y=9 40"
    step, = variants(parse("> R X=1 Y=2.5\n< :A\n"), ("exponents", "glued", "doubled"))
    assert step.sent == b"R X=1e+00Y=25e-01\r\r"


def test_every_module_of_the_transcripts_is_in_the_manifest():
    import tomllib
    known = tomllib.loads((VECTORS / "manifest.toml").read_text())["module"]
    named = {step.argument for file in VECTORS.glob("*.txt") for step in load(file)
             if isinstance(step, Condition) and step.name == "module" and step.argument}
    assert named == set(known)


def test_a_line_that_is_none_is_refused():
    with pytest.raises(TranscriptError, match="t:2"):
        parse("> W\n: A\n", "t")
