# SPDX-License-Identifier: BSD-2-Clause
"""Memory images: what the linker placed is what the memories get."""

import subprocess

import pytest

from soc.top import REGIONS
from tb.sim import build, controller
from tb.sim.test_simulator import FIXTURE

RAM = REGIONS[1].address

SOURCE = """
.section .boot, "ax"
    nop
    .word 0x12345678
    .byte 0xab
.section .app, "ax"
    .byte 1, 2, 3, 4, 5, 6
.section .table, "a"
    .word 0xcafef00d
.section .zero, "aw", @nobits
    .space 64
"""


@pytest.fixture(scope="module")
def elf(tmp_path_factory):
    """An ELF file with the sections of SOURCE where the SoC has its memories."""
    directory = tmp_path_factory.mktemp("elf")
    (directory / "image.S").write_text(SOURCE)
    places = [f"-Wl,--section-start={name}={address:#x}" for name, address in {
        ".boot": 0, ".app": RAM, ".table": RAM + 0x100, ".zero": RAM + 0x200}.items()]
    subprocess.run(["riscv64-unknown-elf-gcc", "-march=rv32im", "-mabi=ilp32", "-misa-spec=2.2", "-nostdlib",
                    *places, "-Wl,-e0", "-o", "image.elf", "image.S"], cwd=directory, check=True)
    return directory / "image.elf"


def test_each_memory_gets_its_part(elf, tmp_path):
    images = controller.write_images([elf], tmp_path)
    assert images["boot"].read_text().split() == ["00000013", "12345678", "000000ab"]
    words = images["firmware"].read_text().split()
    assert words[:3] == ["04030201", "00000605", "00000000"]
    assert words[0x40:] == ["cafef00d"]


def test_bytes_outside_every_memory_are_refused(elf, tmp_path):
    subprocess.run(["riscv64-unknown-elf-objcopy", "--change-section-address", ".table=0x80000000",
                    elf, tmp_path / "astray.elf"], check=True)
    with pytest.raises(ValueError, match="0x80000000"):
        controller.write_images([tmp_path / "astray.elf"], tmp_path)


def test_a_part_that_runs_over_the_end_is_refused():
    with pytest.raises(ValueError, match="do not fit"):
        controller.hex_words([(0x1ffe, bytes(4))], 0, 0x2000)


def test_only_the_right_kind_of_file_is_read():
    with pytest.raises(ValueError, match="ELF"):
        list(controller.load_segments(b"\x7fELF\x02\x01" + bytes(100)))


def test_what_is_up_to_date_is_not_said_to_be_built(monkeypatch):
    said = []
    monkeypatch.setattr(controller, "is_built", lambda verilog: True)
    controller.build()
    controller.build(said.append)
    assert said == []
    monkeypatch.setattr(controller, "is_built", lambda verilog: False)
    controller.build(said.append)
    assert said == ["building the simulator of this gateware, which takes minutes"]


def test_a_simulator_is_known_to_be_built_once_it_is(tmp_path):
    build.build_model(FIXTURE)
    assert build.is_built(FIXTURE)
    (tmp_path / "other.v").write_text(FIXTURE.read_text() + "// another")
    assert not build.is_built(tmp_path / "other.v")


def test_the_gateware_is_written_once_also_where_nothing_was_built(tmp_path, monkeypatch):
    from soc import verilog
    written = []
    monkeypatch.setattr(controller.toolchain, "BUILD", tmp_path / "build")
    monkeypatch.setattr(verilog, "write", lambda directory: (directory.mkdir(parents=True),
                                                             written.append((directory / "abbe.v").write_text("module"))))
    assert controller.write_verilog(lambda sentence: None) == tmp_path / "build" / "soc" / "abbe.v"
    controller.write_verilog(lambda sentence: None)
    assert len(written) == 1
