# SPDX-License-Identifier: BSD-2-Clause
"""The boot program on the SoC: what it does when there is no application to start, and how soon it starts one."""

import re
import subprocess

import pytest
from smp import packet
from smpclient.requests.image_management import ImageStatesRead
from smpclient.requests.os_management import EchoWrite, ResetWrite

from tb import toolchain
from tb.sim import controller
from tb.sim.simulator import MS

CORE = "-march=rv32im -mabi=ilp32 -misa-spec=2.2 --specs=picolibc.specs"


def said(sim):
    sim.run(10 * MS)
    assert sim.levels()["motor_enable"] == 0 or all(sim.levels()[f"{axis}_pwm"] == 0 for axis in "xyzf")
    return sim.serial_read()


@pytest.fixture
def other_gateware(built, tmp_path):
    """Images of a boot program that knows a later register map than this gateware has."""
    header, changed = re.subn(r"(#define REG_MAP_VERSION) (\d+)u", lambda m: f"{m[1]} {int(m[2]) + 1}u",
                              (toolchain.BUILD / "generated" / "regs.h").read_text())
    assert changed == 1
    (tmp_path / "regs.h").write_text(header)
    elf = tmp_path / "out" / "boot.elf"
    subprocess.run(["make", "-C", toolchain.ROOT / "firmware", f"TARGET={elf.parent}", f"CORE_FLAGS={CORE} -I{tmp_path}", elf],
                   check=True, capture_output=True)
    return controller.write_images([elf, controller.FIRMWARE], tmp_path)


def ask(sim, request):
    """The answer to an SMP request, as smpclient understands it."""
    for line in packet.encode(request.BYTES):
        sim.serial_write(line)
    decoder, answer = packet.decode(), b""
    next(decoder)
    sim.run(30 * MS)
    answer = sim.serial_read()
    for line in answer.splitlines(keepends=True):
        try:
            decoder.send(line)
        except StopIteration as end:
            return request._Response.loads(end.value)
    raise AssertionError(f"no whole answer: {answer}")


def test_without_an_application_the_boot_program_serves_updates(built, tmp_path):
    empty = tmp_path / "empty.hex"
    empty.write_text("00000000\n")
    with controller.Controller(built.verilog, built.boot, empty).power_up() as sim:
        assert said(sim) == b""
        assert ask(sim, EchoWrite(d="Abbe")).r == "Abbe"
        assert ask(sim, ImageStatesRead()).images == []
        # A reset starts over, and there is still nothing: what is in RAM is not taken for an application twice.
        ask(sim, ResetWrite())
        assert ask(sim, EchoWrite(d="again")).r == "again"


def test_on_gateware_it_does_not_know_the_boot_program_starts_nothing(built, other_gateware):
    with controller.Controller(built.verilog, other_gateware["boot"], other_gateware["firmware"]).power_up() as sim:
        assert said(sim) == b"Abbe boot: unknown gateware\r\n"


def test_with_both_in_order_the_application_answers(built):
    with built.power_up() as sim:
        assert said(sim) == b""
        assert sim.command("/") == "N\r\n"


def test_the_application_leaves_for_the_update_server(built):
    with built.power_up() as sim:
        sim.run(10 * MS)
        assert "BootLdr V:1" in sim.command("BU X")
        assert sim.command("BU R=1") == ":A \r\n"
        assert said(sim) == b""
        assert ask(sim, EchoWrite(d="Abbe")).r == "Abbe"
        # What is in RAM has run, so it is not trusted: the server again.
        ask(sim, ResetWrite())
        assert ask(sim, EchoWrite(d="again")).r == "again"


def test_at_held_at_power_up_asks_for_the_update_server(built):
    with built.power_up(plant_overrides=("contact_bounce_ms=0",)) as sim:
        sim.set_button("at", 1)
        sim.run(30 * MS)
        assert ask(sim, EchoWrite(d="Abbe")).r == "Abbe"
