# SPDX-License-Identifier: BSD-2-Clause
"""Firmware images for the simulated memories hold what the linker placed, where it placed it."""

import subprocess

import pytest

from tb.demo.controller import write_images

SOURCE = """
    .section .boot, "ax"
    .word 0x11223344
    .section .text
    .word 0xcafef00d
    .byte 1, 2
    .section .data, "aw"
    .balign 4
    .word 0x55aa55aa
"""
LINK = """SECTIONS {{
    .boot 0 : {{ *(.boot) }}
    .text {text:#x} : {{ *(.text) }}
    .data : {{ *(.data) }}
}}
"""


def linked(tmp_path, text):
    """An ELF file with its text at an address."""
    (tmp_path / "a.S").write_text(SOURCE)
    (tmp_path / "a.ld").write_text(LINK.format(text=text))
    subprocess.run(["riscv64-unknown-elf-gcc", "-march=rv32im", "-mabi=ilp32", "-nostdlib", "-T", "a.ld", "a.S",
                    "-Wl,-z,max-page-size=4", "-o", "a.elf"], cwd=tmp_path, check=True, capture_output=True)
    return tmp_path / "a.elf"


def test_words_are_where_the_linker_put_them(tmp_path):
    files = write_images(linked(tmp_path, 0x1_0000), tmp_path)
    assert files["boot"].read_text().split() == ["11223344"]
    assert files["firmware"].read_text().split() == ["cafef00d", "00000201", "55aa55aa"]


def test_a_load_outside_the_memories_is_refused(tmp_path):
    with pytest.raises(ValueError, match="0x80000000, in no memory region"):
        write_images(linked(tmp_path, 0x8000_0000), tmp_path)


def test_another_file_is_refused(tmp_path):
    (tmp_path / "a.elf").write_text("hello")
    with pytest.raises(ValueError, match="ELF"):
        write_images(tmp_path / "a.elf", tmp_path)
