# SPDX-License-Identifier: BSD-2-Clause
"""soc/gateware.py on a small board, from source to bitstream: what is in it, that it repeats, what is done again."""

import hashlib
import json
import random
import subprocess
import sys

import pytest

from soc import contents, gateware, gateware_seeds
from tb import toolchain
from tb.gateware.tiny import CONSTRAINTS, Tiny


def words_of(seed):
    """Made-up firmware: ``{region: words}``, not filling either memory."""
    rng = random.Random(seed)
    return {"boot": [rng.getrandbits(32) for _ in range(2000)], "ram": [rng.getrandbits(32) for _ in range(777)]}


def flow(directory, said=None, text=CONSTRAINTS):
    directory.mkdir(exist_ok=True)
    (directory / "tiny.lpf").write_text(text)
    return gateware.Flow(Tiny, directory=directory, constraints=directory / "tiny.lpf", synthesis="synth_ecp5 -top top; ",
                         say=(said if said is not None else []).append)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    directory = tmp_path_factory.mktemp("flow")
    return directory, flow(directory).pack(1, words_of(1))


def stages(said):
    return [s.split("s  ", 1)[1].split(":")[0] for s in said]


def test_the_bitstream_holds_the_firmware_and_nothing_else_changed(built, tmp_path):
    directory, bitstream = built
    (tmp_path / "abbe.bit").write_bytes(bitstream.read_bytes())
    toolchain.run(["yowasp-ecpunpack", "abbe.bit", "unpacked.config"], cwd=tmp_path)
    packed = contents.BlockRam((tmp_path / "unpacked.config").read_text())
    routed = contents.BlockRam((directory / "seed-1" / "routed.config").read_text())
    for region in Tiny.regions():
        random_words = contents.read_words(directory / "netlist" / f"{region.name}.hex")
        assert len(random_words) == region.size // 4
        wanted = words_of(1)[region.name]
        assert packed.read(routed, random_words) == wanted + [0] * (region.size // 4 - len(wanted))

    def rest(config):
        return (directory / "seed-1" / config).read_text().split(".bram_init")[0]
    assert rest("abbe.config") == rest("routed.config")


def test_new_firmware_needs_no_new_route_and_old_nothing(built):
    directory, bitstream = built
    before, said = bitstream.read_bytes(), []
    flow(directory, said).pack(1, words_of(1))
    assert not said
    flow(directory, said).pack(1, words_of(2))
    assert stages(said) == ["contents of the memories"]
    assert bitstream.read_bytes() != before
    flow(directory, said).pack(1, words_of(1))
    assert bitstream.read_bytes() == before


def test_new_constraints_need_a_new_route_and_a_second_build_gives_the_same_bits(built, tmp_path):
    _, bitstream = built
    said = []
    again = flow(tmp_path / "again", said).pack(1, words_of(1))
    assert stages(said)[0] == "synthesis" and again.read_bytes() == bitstream.read_bytes()
    said.clear()
    other = flow(tmp_path / "again", said, CONSTRAINTS.replace("B2", "C2")).pack(1, words_of(1))
    assert "synthesis" not in stages(said) and "place and route" in stages(said)
    assert other.read_bytes() != bitstream.read_bytes()


def test_the_report_says_what_was_asked_for(built):
    directory, bitstream = built
    report = flow(directory).report(1, bitstream=bitstream)
    assert {name: report[name]["available"] for name in ("lut4", "ff", "ebr", "dsp")} == {
        "lut4": 24288, "ff": 24288, "ebr": 56, "dsp": 28}             # LFE5U-25F: Lattice FPGA-DS-02012, table 1.1
    assert report["ebr"]["used"] == 4 + 8 and report["dsp"]["used"] == 0
    assert report["wanted_mhz"] == {"sync": 50, "fast": 200}
    assert report["bitstream_sha256"] == hashlib.sha256(bitstream.read_bytes()).hexdigest()
    assert report["wall_s"] > 0 and report["seed"] == 1 and json.dumps(report)


def test_a_clock_too_slow_gives_a_report_and_no_bitstream(built, monkeypatch):
    directory, _ = built
    slow = flow(directory)
    timing = directory / "seed-1" / "timing.json"
    text = timing.read_text()
    report = json.loads(text)
    for values in report["fmax"].values():
        values["achieved"] = min(values["achieved"], 199.9)
    timing.write_text(json.dumps(report))
    (directory / "abbe.bit").write_bytes(b"of before")
    try:
        with pytest.raises(gateware.TimingMissed, match="timing missed: fast$"):
            slow.build(1)
        assert not (directory / "abbe.bit").exists()
        assert json.loads((directory / "report.json").read_text())["bitstream_sha256"] is None
        monkeypatch.setattr(gateware, "firmware_words", lambda regions: (words_of(1), "made up", True))
        assert slow.build(1, allow_miss=True)["slack_ns"]["fast"] < 0
        assert (directory / "abbe.bit").exists()
    finally:
        timing.write_text(text)


def test_the_source_of_the_product_does_not_depend_on_the_process():
    """Python hashes strings differently in every process; the design must not."""
    code = ("import hashlib; from soc import gateware; "
            "print(hashlib.sha256(gateware.Flow(gateware.board('ulx3s-85f')).sources()[0].encode()).hexdigest())")
    digests = {subprocess.run([sys.executable, "-c", code], env={**toolchain.environment(), "PYTHONHASHSEED": seed},
                              cwd=toolchain.ROOT, text=True, capture_output=True, check=True).stdout for seed in "12"}
    assert len(digests) == 1 and len(digests.pop().strip()) == 64


def test_an_unknown_board_is_refused_with_the_names_there_are():
    with pytest.raises(SystemExit, match="ulx3s-85f"):
        gateware.board("ulx3s")


def test_five_seeds_of_one_netlist_are_reported_and_a_miss_fails(built, tmp_path, monkeypatch, capsys):
    """With the reports of a routed board in place of its routes."""
    directory, _ = built
    report = flow(directory).report(1)
    slow = report | {"slack_ns": report["slack_ns"] | {"fast": -0.01}}

    class Reports(gateware.Flow):
        def report(self, seed):
            self._tell("asked")
            return (slow if seed == 4 else report) | {"seed": seed}

    (tmp_path / "tiny").mkdir()
    monkeypatch.setattr(gateware_seeds.toolchain, "BUILD", tmp_path)
    monkeypatch.setattr(gateware, "board", lambda name: Tiny)
    monkeypatch.setattr(gateware, "Flow", Reports)
    monkeypatch.setattr("sys.argv", ["seeds", "tiny"])
    with pytest.raises(SystemExit, match="timing missed"):
        gateware_seeds.main()
    assert [r["seed"] for r in json.loads((tmp_path / "tiny" / "seeds.json").read_text())] == [1, 2, 3, 4, 5]
    said = capsys.readouterr().out
    assert all(f"seed {n}     0 s  asked" in said for n in range(1, 6)) and said.count("MISSED") == 1
