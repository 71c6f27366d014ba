# SPDX-License-Identifier: BSD-2-Clause
"""The C unit tests: every ``RUN(sentence)`` of every ``test_*.c`` here is one test.

They are built under AddressSanitizer and UBSan; a finding of theirs fails the test that met it.
"""

import os
import pathlib
import re
import subprocess

import pytest

from tb.firmware.host import build

HERE = pathlib.Path(__file__).parent


def sentences():
    for source in sorted(HERE.glob("test_*.c")):
        for name in re.findall(r"\bRUN\((\w+)\)", source.read_text()):
            yield pytest.param(source.stem, name, id=f"{source.stem}-{name}")


@pytest.mark.parametrize("stem, sentence", list(sentences()))
def test_firmware(stem, sentence):
    run = subprocess.run([build(f"host/{stem}"), sentence], capture_output=True, text=True, timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr


# Those that keep state of the firmware, of which nothing may reach the next test.
STATEFUL = [source.stem for source in sorted(HERE.glob("test_*.c")) if "_start(" in source.read_text()]


@pytest.mark.parametrize("dialect", [{}, {"DIALECT": "1"}], ids=["plain", "dialect"])
@pytest.mark.parametrize("stem", STATEFUL)
def test_one_process_for_all_of_a_file(stem, dialect):
    """Also with the lines as other hosts would say them: exponents, no blanks, CR twice (dialect.h)."""
    run = subprocess.run([build(f"host/{stem}")], env={**os.environ, **dialect}, capture_output=True, text=True,
                         timeout=600)
    assert run.returncode == 0, run.stdout + run.stderr
