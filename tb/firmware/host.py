# SPDX-License-Identifier: BSD-2-Clause
"""Build what ``firmware/Makefile`` knows how to build, once, even when several workers ask at the same time."""

import functools
import subprocess

from tb import toolchain


@functools.cache
def build(name, *variables):
    """Make ``build/<name>``, with variables (``"AXES=3"``), and return its path.

    The compiler's output is in the exception when it fails.
    """
    target = toolchain.BUILD / name
    with toolchain.firmware_lock():
        make = subprocess.run(["make", "--no-print-directory", "-C", toolchain.ROOT / "firmware", *variables,
                               f"../build/{name}"], capture_output=True, text=True)
    assert make.returncode == 0, make.stdout + make.stderr
    return target
