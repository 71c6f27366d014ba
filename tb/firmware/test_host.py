# SPDX-License-Identifier: BSD-2-Clause
"""The C unit tests: every ``RUN(sentence)`` of every ``test_*.c`` here is one test.

``firmware/Makefile`` builds the binaries under AddressSanitizer and UBSan; a finding of theirs
fails the test that met it.
"""

import fcntl
import pathlib
import re
import subprocess

import pytest

HERE = pathlib.Path(__file__).parent
ROOT = HERE.parents[1]
BUILD = ROOT / "build" / "host"


def sentences():
    for source in sorted(HERE.glob("test_*.c")):
        for name in re.findall(r"\bRUN\((\w+)\)", source.read_text()):
            yield pytest.param(source.stem, name, id=f"{source.stem}-{name}")


@pytest.fixture(scope="session")
def host_binary():
    """Build one test binary, once, even when several workers ask at the same time."""
    built = {}

    def build(stem):
        if stem not in built:
            BUILD.mkdir(parents=True, exist_ok=True)
            with open(BUILD / ".lock", "w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                make = subprocess.run(
                    ["make", "--no-print-directory", "-C", ROOT / "firmware", f"../build/host/{stem}"],
                    capture_output=True, text=True)
            assert make.returncode == 0, make.stdout + make.stderr
            built[stem] = BUILD / stem
        return built[stem]

    return build


@pytest.mark.parametrize("stem, sentence", sentences())
def test_firmware(host_binary, stem, sentence):
    run = subprocess.run([host_binary(stem), sentence], capture_output=True, text=True, timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr
