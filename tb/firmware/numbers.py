# SPDX-License-Identifier: BSD-2-Clause
"""``make test-numbers``: a million numbers, formatted and parsed by the objects of the target and by those of the host, to the byte.

The target's objects, soft floating point and all, run as a Linux program under qemu-riscv32, which is installed if it is
not there; the soft core itself, in simulation, converts the first 150 of the same numbers in
``test_number_on_target.py``.
"""

import hashlib
import shutil
import subprocess
import sys

from tb import toolchain
from tb.firmware.host import build

COUNT = 1_000_000


def lines(command):
    """What a program prints, line by line; :exc:`RuntimeError` if it fails."""
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        yield from process.stdout
    if process.returncode:
        raise RuntimeError(f"{command[0]} ended with status {process.returncode}")


def compare(target, host):
    """Lines, bytes and SHA-256 of two equal outputs; :exc:`AssertionError` names the first line that differs."""
    digest, count, size, end = hashlib.sha256(), 0, 0, object()
    host = iter(host)
    for count, ours in enumerate(target, 1):
        theirs = next(host, b"nothing")
        assert ours == theirs, f"line {count}: the target has {ours!r}, the host {theirs!r}"
        digest.update(ours)
        size += len(ours)
    assert next(host, end) is end, f"the target ends after {count} lines"
    return count, size, digest.hexdigest()


def main():
    if not shutil.which("qemu-riscv32"):
        subprocess.run([toolchain.ROOT / "host" / "setup.sh", "qemu-user"], check=True)
    count, size, digest = compare(lines(["qemu-riscv32", build("firmware/numbers-linux")]), lines([build("host/numbers")]))
    assert count == COUNT, f"{count} lines, not {COUNT}"
    print(f"{count} numbers formatted and {count} parsed, {size} bytes: the same on target and host (SHA-256 {digest[:16]})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
