# SPDX-License-Identifier: BSD-2-Clause
"""A sample of ``make powercut``, and that it finds what it is for."""

import os

import pytest

from tb import toolchain
from tb.firmware.host import build
from tb.powercut.powercut import run, scenarios

SEED = int(os.environ.get("SEED", 1))
STORE = toolchain.ROOT / "firmware" / "store" / "settings_flash.c"


@pytest.fixture(scope="module")
def program():
    return build("powercut/powercut")


def test_some_cuts_of_every_scenario(program):
    for name in scenarios(program):
        cuts = run(program, name, every=29, pairs=2, seed=SEED)
        assert not cuts.failed, "\n".join(cuts.failures)
        assert cuts.passed > 150


@pytest.mark.parametrize("right, wrong", [
    ("    lfs_ssize_t written;\n", "    lfs_ssize_t written;\n    (void)lfs_remove(&lfs, file_name);\n"),
    ("    written = lfs_file_write(", "    (void)lfs_file_write(&lfs, &file, image, 100);\n    (void)lfs_file_sync(&lfs, &file);\n"
     "    (void)lfs_file_rewind(&lfs, &file);\n    written = lfs_file_write("),
    ("    int status = mount();\n\n    if (status", "    int status = format();\n\n    if (status"),
], ids=["the old file is removed first", "half of the file is kept", "formatted each time"])
def test_a_store_that_does_it_wrong_is_found(right, wrong):
    seeded = toolchain.BUILD / "powercut" / "seeded.c"
    source = STORE.read_text()
    assert source.count(right) == 1
    seeded.parent.mkdir(parents=True, exist_ok=True)
    seeded.write_text(source.replace(right, wrong))
    cuts = run(build("powercut/seeded"), "save", every=5, seed=SEED)
    assert cuts.failed > 0
