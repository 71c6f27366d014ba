# SPDX-License-Identifier: BSD-2-Clause
"""Build what ``firmware/Makefile`` knows how to build, once, even when several workers ask at the same time."""

import fcntl
import functools
import subprocess

from tb import toolchain


@functools.cache
def build(name):
    """Make ``build/<name>`` and return its path; the compiler's output is in the exception when it fails."""
    target = toolchain.BUILD / name
    # The lock of tb.sim.controller, which makes the same files.
    (toolchain.BUILD / "sim").mkdir(parents=True, exist_ok=True)
    with open(toolchain.BUILD / "sim" / "controller.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        make = subprocess.run(["make", "--no-print-directory", "-C", toolchain.ROOT / "firmware", f"../build/{name}"],
                              capture_output=True, text=True)
    assert make.returncode == 0, make.stdout + make.stderr
    return target
