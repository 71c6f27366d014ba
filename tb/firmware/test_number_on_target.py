# SPDX-License-Identifier: BSD-2-Clause
"""Numbers on the soft core: the same vectors as on the host, and the same bytes out of them."""

import re
import subprocess

from tb import toolchain
from tb.firmware.host import build
from tb.sim import controller
from tb.sim.simulator import S, Simulator


def test_numbers_come_out_alike_on_target_and_host(tmp_path):
    host = subprocess.run([build("host/test_number"), "gives_the_digest_the_target_is_compared_with"],
                          capture_output=True, text=True, check=True).stdout
    expected = re.search(r"digest (\w{8})", host).group(1)

    from soc import verilog
    design = verilog.write(toolchain.BUILD / "soc")
    images = controller.write_images(build("firmware/numbers.elf"), tmp_path)
    with Simulator(verilog=design, **images) as sim:
        sim.run_until_lines(1, timeout_ps=2 * S)
        assert sim.serial_read().decode().strip() == expected
