# SPDX-License-Identifier: BSD-2-Clause
"""Numbers on the soft core: the same vectors as on the host, and the same bytes out of them."""

import re
import subprocess

import pytest

from tb import toolchain
from tb.firmware.host import build
from tb.firmware.numbers import compare
from tb.sim import controller
from tb.sim.simulator import S, Simulator


def test_numbers_come_out_alike_on_target_and_host(tmp_path):
    host = subprocess.run([build("host/test_number"), "gives_the_digest_the_target_is_compared_with"],
                          capture_output=True, text=True, check=True).stdout
    expected = re.search(r"digest (\w{8})", host).group(1)

    from soc import verilog
    design = verilog.write(toolchain.BUILD / "soc")
    images = controller.write_images([build("firmware/boot.elf"), build("firmware/numbers.elf")], tmp_path)
    with Simulator(verilog=design, **images) as sim:
        sim.run_until_lines(1, timeout_ps=2 * S)
        assert sim.serial_read().decode().strip() == expected


def test_the_comparison_of_a_million_numbers_finds_the_line_that_differs():
    same = [b"1.0 3ff0000000000000\n", b"2 4000000000000000\n"]
    assert compare(iter(same), iter(same))[:2] == (2, sum(map(len, same)))
    with pytest.raises(AssertionError, match="line 2"):
        compare(same, [same[0], b"2 4000000000000001\n"])
    with pytest.raises(AssertionError, match="line 2.*nothing"):
        compare(same, same[:1])
    with pytest.raises(AssertionError, match="ends after 1"):
        compare(same[:1], same)
