# SPDX-License-Identifier: BSD-2-Clause
"""The boot program when it cannot start the application: it says why on the serial port, and drives nothing."""

import re
import subprocess

import pytest

from tb import toolchain
from tb.sim import controller
from tb.sim.simulator import MS

FLAGS = ["-march=rv32im", "-mabi=ilp32", "-misa-spec=2.2", "--specs=picolibc.specs", "-Os", "-ffunction-sections"]

# Stands in for the application; it would show by what it does not say.
APPLICATION = """
    .section .start, "ax"
    .globl application_start
application_start:
    j application_start
"""


def said(sim):
    sim.run(10 * MS)
    assert sim.levels()["motor_enable"] == 0 or all(sim.levels()[f"{axis}_pwm"] == 0 for axis in "xyzf")
    return sim.serial_read()


@pytest.fixture
def other_gateware(built, tmp_path):
    """Images of a boot program that knows a later register map than this gateware has."""
    firmware, generated = toolchain.ROOT / "firmware", toolchain.BUILD / "generated"
    header, changed = re.subn(r"(#define REG_MAP_VERSION) (\d+)u", lambda m: f"{m[1]} {int(m[2]) + 1}u",
                              (generated / "regs.h").read_text())
    assert changed == 1
    (tmp_path / "regs.h").write_text(header)
    (tmp_path / "application.S").write_text(APPLICATION)
    (tmp_path / "boot").mkdir()
    gcc = ["riscv64-unknown-elf-gcc", *FLAGS, "-I", tmp_path, "-I", firmware]
    objects = []
    for source in (firmware / "boot" / "boot.S", firmware / "boot" / "boot.c", tmp_path / "application.S"):
        objects.append(tmp_path / "boot" / f"{source.name}.o")
        subprocess.run([*gcc, "-c", source, "-o", objects[-1]], check=True)
    subprocess.run([*gcc, "-nostartfiles", f"-L{generated}", "-T", firmware / "link.ld", *objects,
                    "-o", tmp_path / "other.elf"], check=True)
    return controller.write_images(tmp_path / "other.elf", tmp_path)


def test_without_an_application_the_boot_program_says_so(built, tmp_path):
    empty = tmp_path / "empty.hex"
    empty.write_text("00000000\n")
    with controller.Controller(built.verilog, built.boot, empty).power_up() as sim:
        assert said(sim) == b"Abbe boot: no application\r\n"


def test_on_gateware_it_does_not_know_the_boot_program_starts_nothing(built, other_gateware):
    with controller.Controller(built.verilog, other_gateware["boot"], other_gateware["firmware"]).power_up() as sim:
        assert said(sim) == b"Abbe boot: unknown gateware\r\n"


def test_with_both_in_order_the_application_answers(built):
    with built.power_up() as sim:
        assert said(sim) == b""
        assert sim.command("/") == "N\r\n"
