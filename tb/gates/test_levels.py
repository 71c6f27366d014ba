# SPDX-License-Identifier: BSD-2-Clause
"""tb/gates/levels.py names tests that exist: a name that does not match would silently run nothing."""

import re

import pytest

from tb import toolchain
from tb.gates.levels import ORDINARY


@pytest.mark.parametrize("nodeid", sorted(ORDINARY))
def test_every_test_named_uses_the_netlist(nodeid):
    path, name = re.fullmatch(r"(.*)::(\w+)\[gates(?:-\w+)?\]", nodeid).groups()
    assert re.search(rf"^def {name}\(.*\bsimulate\b.*\):$", (toolchain.ROOT / path).read_text(), re.MULTILINE)
