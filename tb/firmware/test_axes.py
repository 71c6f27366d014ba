# SPDX-License-Identifier: BSD-2-Clause
"""A build with fewer axes: the same sources, the same test."""

import subprocess

from tb.firmware.host import build


def test_a_controller_with_three_axes():
    run = subprocess.run([build("host-3/test_axes", "AXES=3")], capture_output=True, text=True, timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr
