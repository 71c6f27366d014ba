# SPDX-License-Identifier: BSD-2-Clause
"""The simulator by itself, around the stand-in controller of fixture.v."""

import io

import numpy
import pytest
from vcd.reader import TokenKind, tokenize

from tb.board.board import Board
from tb.sim.build import HERE
from tb.sim.simulator import CHANGE, MS, SCAN_SIGNALS, SIGNALS, SYNC_PERIOD_PS, US, Simulator, Timeout
from tb.sim.vcd import VcdWriter

FIXTURE = HERE / "fixture.v"
GREETING = b"AB\r\n"


@pytest.fixture
def make(tmp_path):
    made = []

    def build(*, on=(1000, 500), **kwargs):
        firmware, boot = tmp_path / f"firmware{len(made)}.hex", tmp_path / "boot.hex"
        firmware.write_text("".join(f"{clocks:08x}\n" for clocks in (*on, 0, 0)))
        boot.write_text(f"{int.from_bytes(GREETING, 'little'):08x}\n0\n0\n0\n")
        made.append(Simulator(boot=boot, firmware=firmware, verilog=FIXTURE, **kwargs))
        return made[-1]
    yield build
    for sim in made:
        sim.close()


def of(changes, signal):
    """Times and levels of one pin."""
    own = changes[changes["signal"] == SIGNALS.index(signal)]
    return own["time_ps"], own["level"]


def sampled_ps(times_ps):
    """The first `fast` clock edge after each time, as an input sees it."""
    return times_ps // 5000 * 5000 + 5000


def test_images_load_at_run_time_without_a_build(make):
    for on in (1000, 1), (2, 2499):
        sim = make(on=on)
        sim.record("x_pwm", "y_pwm")
        sim.run(MS)
        changes = sim.changes()
        for signal, clocks in zip(("x_pwm", "y_pwm"), on):
            times, levels = of(changes, signal)
            assert levels.tolist()[:38] == [1, 0] * 19
            assert numpy.diff(times).tolist()[:38] == [clocks * 20_000, (2500 - clocks) * 20_000] * 19


def test_the_encoder_moves_only_as_the_pwm_pins_drive_the_board(make):
    """The recorded drive, played to another board, gives the recorded encoder edges, to the picosecond."""
    sim, alone = make(plant_overrides=["x.speed_scale=0.5"]), Board("x.speed_scale=0.5")
    pins = [f"{axis}_{pin}" for pin in ("pwm", "dir") for axis in "xyzf"] + ["motor_enable"]
    encoder = [f"{axis}_{pin}" for axis in "xy" for pin in "ab"]
    sim.record(*pins, *encoder)
    sim.run(15 * MS)
    level = dict.fromkeys(range(len(SIGNALS)), 0)
    expected, last = [], {signal: alone.pins for signal in encoder}

    def look():
        return {f"{axis}_{pin}": getattr(alone.pins, f"enc_{pin}") >> n & 1 for n, axis in enumerate("xy") for pin in "ab"}

    def play(until_ps):
        nonlocal last
        for edge in alone.edges(until_ps - alone.time_ps):
            now = look()
            expected.extend((edge.time_ps, signal, now[signal]) for signal in encoder if now[signal] != last[signal])
            last = now

    last = look()
    changes = sim.changes()
    for time_ps, signal, value in changes.tolist():
        if SIGNALS[signal] in pins:
            play(time_ps)
            level[signal] = value
            word = {pin: sum(level[SIGNALS.index(f"{axis}_{pin}")] << n for n, axis in enumerate("xyzf"))
                    for pin in ("pwm", "dir")}
            alone.drive_pins(**word, motor_enable=level[SIGNALS.index("motor_enable")])
    play(15 * MS)
    got = [(time_ps, SIGNALS[signal], value) for time_ps, signal, value in changes.tolist()
           if SIGNALS[signal] in encoder]
    assert len(got) > 500
    assert got == expected
    assert sim.position_counts(0) == alone.position_counts(0) > 100
    assert sim.count(1) == alone.count(1) < -100


def test_buttons_reach_the_controller_and_its_pins_the_converter(make):
    """The stand-in shows ZERO on the converter's data pin: the converter, selected all the time, pulls its own low."""
    sim = make()
    sim.run(US)
    assert sim.pins.adc_miso == 1
    sim.set_button("home", 1)
    sim.run(10 * MS)
    assert (sim.pins.button, sim.pins.adc_miso) == (2, 1)
    sim.set_button("zero", 1)
    sim.run(10 * MS)
    assert (sim.pins.button, sim.pins.adc_miso) == (6, 0)


def test_the_flash_answers_at_its_pins_when_one_is_fitted(make, tmp_path):
    """The fixture shows each bit it has read, inverted, for 40 ns: those of the opcode's byte, then the identification."""
    def bits(sim):
        sim.record("f_dir")
        sim.run(1 * US)
        sim.changes()
        begin, level = sim.time_ps, sim.levels()["f_dir"]
        sim.run(6 * US)
        times, levels = of(sim.changes(), "f_dir")
        at = numpy.searchsorted(times, begin + numpy.arange(0, 6 * US, 40_000), "right")
        return "".join(str(1 - int(bit)) for bit in numpy.concatenate([[level], levels])[at])

    assert set(bits(make())) == {"1"}
    assert f"{0xffef4018:032b}" in bits(make(flash=b""))


def test_what_the_flash_holds_outlives_the_power(make, tmp_path):
    file = tmp_path / "flash.bin"
    with make(flash=file) as sim:
        assert sim.flash() == b"\xff" * (16 << 20)
    file.write_bytes(b"Abbe" + file.read_bytes()[4:])
    with make(flash=file) as sim:
        assert sim.flash(0, 6) == b"Abbe\xff\xff"
    assert file.read_bytes()[:5] == b"Abbe\xff"
    assert make(flash=b"123").flash(1, 3) == b"23\xff"
    with pytest.raises(ValueError, match="no flash is fitted"):
        make().flash()


def test_an_input_is_seen_by_the_first_fast_edge_after_it(make):
    sim = make(on=(2000, 0))
    sim.record("x_a", "encoder")
    sim.run(30 * MS)
    changes = sim.changes()
    (edges, levels), (seen, seen_levels) = of(changes, "x_a"), of(changes, "encoder")
    seen, seen_levels = seen[-len(edges):], seen_levels[-len(edges):]  # the first may be the pin's level at power-up
    assert len(edges) > 1000
    assert len({time % 5000 for time in edges.tolist()}) > 0.3 * len(edges)
    assert (seen == sampled_ps(edges) + 5000).all() and (seen_levels == levels).all()


def test_the_pins_rise_where_the_recorded_edges_say(make):
    """SYNC of the stand-in is count > 100: counted here from the recorded edges of A and B."""
    sim = make(on=(2000, 0))
    sim.record("x_a", "x_b", "sync")
    start = sim.levels()
    sim.run_until_pin("sync", 1, timeout_ps=50 * MS)
    changes = sim.changes()
    edges = changes[changes["signal"] != SIGNALS.index("sync")]
    times, levels = of(changes, "sync")
    assert levels.tolist() == [1]
    assert start["sync"] == 0
    # 101 edges, and the stage has not turned. A clock after it is sampled an edge is counted, and then compared.
    assert times[0] == sampled_ps(edges["time_ps"][100]) + 2 * 5000
    assert sim.time_ps == times[0] // SYNC_PERIOD_PS * SYNC_PERIOD_PS + SYNC_PERIOD_PS


def test_bytes_go_out_and_come_back_at_the_programmed_baud(make):
    sim = make()
    sim.run_until_lines(1, timeout_ps=MS)
    data, times = sim.serial_read_timed()
    assert data == GREETING
    assert set(numpy.diff(times)) <= {10 * 434 * 20_000 + extra * 20_000 for extra in range(12)}
    sim.record("serial_rx")
    sent = bytes(range(1, 255))
    begin_ps = sim.time_ps
    sim.serial_write(sent)
    assert sim.serial_unsent == len(sent)
    sim.run_until(lambda: sim.serial_unsent == 0, timeout_ps=40 * MS)
    sim.run(MS)
    assert sim.serial_read() == bytes(byte + 1 for byte in sent)
    assert sim.serial_framing_errors == 0
    bits = [bit for byte in sent for bit in (0, *(byte >> n & 1 for n in range(8)), 1)]
    expected = [begin_ps + n * 1e12 / 115200 for n in range(len(bits)) if bits[n] != (bits[n - 1] if n else 1)]
    times, levels = of(sim.changes(), "serial_rx")
    assert len(times) == len(expected)
    assert abs(times - numpy.array(expected)).max() <= len(sent)  # each byte's start is rounded to 1 ps


def test_another_baud_changes_the_length_of_a_bit(make):
    sim = make()
    sim.serial_set_baud(230400)
    sim.record("serial_rx")
    sim.serial_write(b"UU")
    sim.run(MS)
    times, _ = of(sim.changes(), "serial_rx")
    assert len(times) == 20 and abs(numpy.diff(times) - 1e12 / 230400).max() <= 1


def test_a_byte_without_a_stop_bit_is_counted_and_not_received(make):
    """The stand-in answers with a zero byte, low for nine bits: at twice the baud, no stop bit in the tenth."""
    sim = make()
    sim.run(MS)
    assert sim.serial_read() == GREETING
    sim.serial_write(b"\xff")
    sim.run(20 * US)
    sim.serial_set_baud(230400)
    sim.run(MS)
    assert (sim.serial_read(), sim.serial_framing_errors) == (b"", 1)


def test_the_report_line_is_heard_beside_the_other_at_a_rate_of_its_own(make):
    """The stand-in repeats on it what it is sent."""
    sim = make()
    sim.run(US)                             # out of reset
    sim.record("serial_rx", "report_tx")
    sim.serial_write(b"Abbe")
    sim.run(MS)
    data, times = sim.report_read_timed()
    assert (data, sim.report_read(), sim.report_framing_errors) == (b"Abbe", b"", 0)
    changes = sim.changes()
    sent, heard = of(changes, "serial_rx")[0], of(changes, "report_tx")[0]
    assert len(heard) == len(sent) and times[0] == heard[0] and 20_000 < (heard - sent).min()
    sim.report_set_baud(230400)
    sim.serial_write(b"\xff\x00")          # low for one bit, and for nine: two bytes, and one without a stop bit
    sim.run(MS)
    assert sim.report_read()[:1] != b"\xff" and sim.report_framing_errors == 1


def test_command_returns_the_reply_and_nothing_older(make):
    sim = make()
    sim.run(MS)  # the greeting is waiting
    assert sim.command("ZAP\x0c\x09", timeout_ps=5 * MS) == "[BQ\r\n"
    with pytest.raises(Timeout, match="IBMU"):
        sim.command("HALT", timeout_ps=2 * MS)


def test_the_cpu_clock_stops_while_the_cpu_is_asleep(make):
    sim = make()
    sim.run(10 * US)
    clocks, awake = sim.clocks
    sim.record("z_dir")
    sim.run(320 * US)
    assert (sim.clocks[0] - clocks, sim.clocks[1] - awake) == (16_000, 1000)
    assert set(numpy.diff(of(sim.changes(), "z_dir")[0])) == {16 * 16 * 20_000}
    sim.set_input("estop", 1)
    sim.run(US)
    sim.changes()
    clocks, awake = sim.clocks
    sim.run(320 * US)
    assert (sim.clocks[0] - clocks, sim.clocks[1] - awake) == (16_000, 16_000)
    assert set(numpy.diff(of(sim.changes(), "z_dir")[0])) == {16 * 20_000}


def test_estop_reaches_the_controller_and_its_enable_the_motors(make):
    sim = make(on=(2400, 0))
    sim.run(20 * MS)
    assert sim.speed_counts_per_s(0) > 100_000
    sim.set_input("estop", 1)
    sim.run(100 * MS)
    assert sim.levels()["motor_enable"] == 0 and sim.levels()["x_pwm"] in (0, 1)
    assert sim.speed_counts_per_s(0) == 0


def test_cut_pwm_wires_stop_the_stage(make):
    sim = make(on=(2400, 2400))
    sim.run(20 * MS)
    sim.cut_pwm([0])
    sim.run(100 * MS)
    assert sim.speed_counts_per_s(0) == 0 and sim.speed_counts_per_s(1) < -100_000


def test_a_stuck_wire_is_stuck_at_the_controller(make):
    sim = make(on=(2400, 0))
    sim.stick_wire(0, "a", 0)
    sim.run(20 * MS)
    sim.record("x_a", "x_b", "encoder")
    sim.run(5 * MS)
    changes = sim.changes()
    assert set(changes["signal"]) == {SIGNALS.index("x_b")}


def test_scheduled_inputs_change_between_clocks(make):
    sim = make()
    sim.record("in0", "out0")
    toggles = [100_000_001, 100_004_999, 100_009_999, 100_010_000, 200_000_000, 300_012_345]
    for n, time_ps in enumerate(toggles):
        sim.schedule_input(time_ps, "in0", 1 - n % 2)
    sim.run(MS)
    changes = sim.changes()
    assert of(changes, "in0")[0].tolist() == toggles
    # The first pulse ends before a clock sees it; the second is seen, being high at 100.010000 us exactly not yet low.
    times, levels = of(changes, "out0")
    assert times.tolist() == [100_015_000, 100_020_000, 200_010_000, 300_020_000]
    assert levels.tolist() == [1, 0, 1, 0]


def test_samples_show_the_true_motion(make):
    sim = make(on=(2000, 0))
    sim.sample(100 * US)
    sim.run(10 * MS)
    samples = sim.samples()
    assert samples["time_ps"].tolist() == [n * 100 * US for n in range(1, 100)]
    speeds, positions = samples["speed_counts_per_s"][:, 0], samples["position_counts"][:, 0]
    assert speeds[-1] > 100_000
    # Trapezoids over the sampled speed give the sampled way, but for PWM ripple and the knee at break-away.
    way = ((speeds[1:] + speeds[:-1]) / 2 * 100e-6).sum()
    assert positions[-1] - positions[0] == pytest.approx(way, rel=0.01)
    assert (samples["position_counts"][:, 1] == samples["position_counts"][0, 1]).all()


def test_only_chosen_pins_are_recorded_and_only_while_recording(make):
    sim = make()
    sim.run(MS)
    assert len(sim.changes()) == 0
    sim.record("x_pwm")
    sim.run(MS)
    sim.record()
    sim.run(MS)
    changes = sim.changes()
    assert set(changes["signal"]) == {SIGNALS.index("x_pwm")} and len(changes) == 40
    assert len(sim.changes()) == 0


def test_waiting_ends_with_the_time_allowed(make):
    sim = make()
    with pytest.raises(Timeout):
        sim.run_until_pin("in1", 1, timeout_ps=MS)
    assert sim.time_ps == MS
    with pytest.raises(Timeout):
        sim.run_until(lambda: False, timeout_ps=MS)
    assert sim.time_ps == 2 * MS


def test_two_runs_are_the_same_to_the_picosecond(make):
    def run():
        sim = make()
        sim.record(*SIGNALS)
        sim.serial_write(b"W X Y\r")
        sim.run(10 * MS)
        return sim.changes().tolist()
    first = run()
    assert len(first) > 500 and first == run()


def test_the_vcd_holds_the_recorded_changes(make):
    sim = make(on=(2000, 1500))
    sim.run(5 * MS)
    file = io.StringIO()
    writer = VcdWriter(file, time_ps=sim.time_ps, levels=sim.levels())
    sim.record(*SIGNALS)
    expected = []
    for _ in range(3):
        sim.run(2 * MS)
        changes = sim.changes()
        writer.write(changes)
        expected += [(time, SIGNALS[signal], str(level)) for time, signal, level in changes.tolist()
                     if SIGNALS[signal] in SCAN_SIGNALS]
    writer.finish(sim.time_ps)
    names, now_ps, got, dumped = {}, None, [], {}
    for token in tokenize(io.BytesIO(file.getvalue().encode())):
        if token.kind is TokenKind.TIMESCALE:
            assert (token.timescale.magnitude.value, token.timescale.unit.value) == (1, "ps")
        elif token.kind is TokenKind.VAR:
            names[token.var.id_code] = token.var.reference
        elif token.kind is TokenKind.CHANGE_TIME:
            now_ps = token.time_change
        elif token.kind is TokenKind.CHANGE_SCALAR:
            if now_ps == 5 * MS and len(dumped) < len(names):
                dumped[names[token.scalar_change.id_code]] = token.scalar_change.value
            else:
                got.append((now_ps, names[token.scalar_change.id_code], token.scalar_change.value))
    assert tuple(names.values()) == SCAN_SIGNALS == tuple(dumped)
    assert got == expected and len(got) > 500
    assert now_ps == 11 * MS


def test_the_vcd_keeps_times_a_picosecond_apart_and_joins_equal_ones():
    def change(time_ps, signal, level):
        return time_ps, SIGNALS.index(signal), level
    file = io.StringIO()
    writer = VcdWriter(file, time_ps=100, levels={"sync": 0, "in0": 1}, signals=("sync", "in0"))
    writer.write(numpy.array([change(100, "sync", 1), change(101, "in0", 0), change(101, "sync", 0),
                              change(102, "x_a", 1), change(102, "in0", 1)], CHANGE))
    writer.finish(102)
    _, body = file.getvalue().split("$end\n#100\n")
    assert body == "$dumpvars\n0!\n1\"\n$end\n1!\n#101\n0\"\n0!\n#102\n1\"\n"


def test_waiting_for_a_pin_ends_with_its_change_to_the_level_asked_for(make):
    sim = make()
    sim.run_until_pin("x_pwm", 1, timeout_ps=MS)
    rise_ps = sim.time_ps
    sim.run_until_pin("x_pwm", 0, timeout_ps=MS)
    assert sim.time_ps - rise_ps == 1000 * SYNC_PERIOD_PS
    sim.run_until_pin("x_pwm", 1, timeout_ps=MS)
    assert sim.time_ps - rise_ps == 2500 * SYNC_PERIOD_PS


def test_wrong_arguments_are_refused(tmp_path):
    with pytest.raises(ValueError, match="pitch"):
        Simulator(verilog=FIXTURE, plant_overrides=["x.pitch=1"])
    with pytest.raises(FileNotFoundError):
        Simulator(verilog=FIXTURE, firmware=tmp_path / "none.hex")
    with pytest.raises(FileNotFoundError):
        Simulator(verilog=tmp_path / "none.v")
