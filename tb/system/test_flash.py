# SPDX-License-Identifier: BSD-2-Clause
"""The flash on the SoC: the driver over the real gateware, the start with and without a flash, and what outlives the power."""

import pytest
from smpclient.requests.os_management import EchoWrite

from tb import toolchain
from tb.firmware.boot_images import sign
from tb.firmware.host import build
from tb.sim import controller
from tb.sim.simulator import MS, S, US
from tb.system.test_boot import ask, said

KEY = toolchain.ROOT / ".keys" / "development.pem"
SLOT, COUNTER, PLACE, SIZE = 0x400000, 0x3fe000, 0x6000f3, 700
FAST = {"program_ps": 100 * US, "erase_ps": 2 * MS}           # what a test does not wait for


def instead(built, name, directory):
    """The controller with another program than the application: tb/firmware/<name>_target.c."""
    images = controller.write_images([build("firmware/boot.elf"), build(f"firmware/{name}.elf")], directory)
    return controller.Controller(built.verilog, images["boot"], images["firmware"])


def test_without_a_flash_the_application_starts_within_a_millisecond(built, tmp_path):
    with instead(built, "flash", tmp_path).power_up() as sim:
        sim.run(4 * MS)
        text, times = sim.serial_read_timed()
        assert text.decode() == "begin nnnnnnnn end\r\n"
        print(f"reset to the first byte of the application: {times[0] / US:.0f} us")
        assert times[0] < 1 * MS


def test_the_driver_erases_programs_and_reads_over_the_gateware(built, tmp_path):
    contents = bytes(range(256)) * (0x700000 // 256)
    with instead(built, "flash", tmp_path).power_up(flash=contents) as sim:
        sim.set_flash_times(**FAST)
        sim.run_until_lines(1, timeout_ps=60 * MS)
        text, times = sim.serial_read_timed()
        assert text.decode() == "begin yyyyynnn end\r\n"
        print(f"reset to the first byte of the application, no slot valid: {times[0] / US:.0f} us")
        first = PLACE & ~0xfff
        sector = bytearray(b"\xff" * 4096)
        sector[PLACE - first:PLACE - first + SIZE] = bytes((n * 7 + n // 256) % 256 for n in range(SIZE))
        assert sim.flash(0, len(contents)) == contents[:first] + sector + contents[first + 4096:]


def test_settings_outlive_the_power(built, tmp_path):
    file = tmp_path / "flash.bin"
    for share, saved in (0, 33), (33, None):
        with built.power_up(flash=file) as sim:
            sim.set_flash_times(**FAST)
            sim.run(30 * MS)
            assert sim.command("LED X?") == f"X={share} :A\r\n"
            if saved:
                assert sim.command(f"LED X={saved}") == ":A \r\n"
                assert sim.command("SS Z", timeout_ps=1 * S) == ":A \r\n"
            assert sim.command("LED X=55") == ":A \r\n"


def test_an_image_that_overwrites_all_memory_leaves_the_boot_program(built, tmp_path):
    with instead(built, "overwrite", tmp_path).power_up() as sim:
        sim.run(5 * MS)
        assert sim.serial_read() == b"begin\r\n"
        sim.run(40 * MS)
        assert said(sim) == b""
        assert ask(sim, EchoWrite(d="Abbe")).r == "Abbe"


@pytest.mark.slow
def test_a_signed_image_starts_from_its_slot(built, tmp_path):
    """Not what came with the bitstream; and the downgrade counter has its version, which the image cannot change."""
    image = sign(tmp_path / "image.bin", build("firmware/flash.bin").read_bytes(), "--pad", "--confirm", key=KEY)
    empty = tmp_path / "empty.hex"
    empty.write_text("00000000\n")
    boot = controller.write_images([build("firmware/boot.elf")], tmp_path)["boot"]
    with controller.Controller(built.verilog, boot, empty).power_up(flash=b"\xff" * SLOT + image.read_bytes()) as sim:
        sim.set_flash_times(**FAST)
        sim.run_until_lines(1, timeout_ps=3 * S)
        text, times = sim.serial_read_timed()
        assert text.decode() == "begin yyyyynnn end\r\n"
        print(f"reset to the first byte of the application from a slot: {times[0] / MS:.0f} ms")
        assert sim.flash(COUNTER, 16) != b"\xff" * 16
