# SPDX-License-Identifier: BSD-2-Clause
"""A sample of ``make powercut``, and that it finds what it is for."""

import os

import pytest

from tb import toolchain
from tb.firmware.host import build
from tb.powercut.powercut import Broken, run, scenarios

SEED = int(os.environ.get("SEED", 1))
@pytest.fixture(scope="module")
def program():
    return build("powercut/powercut")


def test_some_cuts_of_every_scenario(program):
    for name in scenarios(program):
        cuts = run(program, name, every=29, pairs=2, seed=SEED)
        assert not cuts.failed, "\n".join(cuts.failures)
        assert cuts.passed > 8


STORE, SLOT = "store/settings_flash", "boot/slot"


@pytest.mark.parametrize("scenario, file, right, wrong", [
    pytest.param("save", STORE, "    lfs_ssize_t written;\n", "    lfs_ssize_t written;\n    (void)lfs_remove(&lfs, file_name);\n",
                 id="the-old-file-is-removed-first"),
    pytest.param("save", STORE, "    written = lfs_file_write(",
                 "    (void)lfs_file_write(&lfs, &file, image, 100);\n    (void)lfs_file_sync(&lfs, &file);\n"
                 "    (void)lfs_file_rewind(&lfs, &file);\n    written = lfs_file_write(", id="half-of-the-file-is-kept"),
    pytest.param("save", STORE, "    int status = mount();\n\n    if (status", "    int status = format();\n\n    if (status",
                 id="formatted-each-time"),
    pytest.param("select for good", SLOT, "put(slot, GENERATION_AT, generation, sizeof generation) &&",
                 "put(slot, GENERATION_AT, generation, sizeof generation) && put(slot, MAGIC_AT, magic, sizeof magic) &&",
                 id="selected-before-it-is-confirmed"),
    pytest.param("upload", SLOT, "    return best;\n}\n\n/* Program part", "    return 1 - best;\n}\n\n/* Program part",
                 id="uploaded-over-what-runs"),
])
def test_a_fault_is_found(request, scenario, file, right, wrong):
    source = (toolchain.ROOT / "firmware" / f"{file}.c").read_text()
    name = f"powercut/seeded-{request.node.callspec.id}"
    assert source.count(right) == 1
    path = toolchain.BUILD / f"{name}.c"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(source.replace(right, wrong))
    try:
        assert run(build(name, f"SEEDED={file}"), scenario, every=5, seed=SEED).failed > 0
    except Broken as broken:
        assert "not what its name says" in str(broken)      # without any cut
