# SPDX-License-Identifier: BSD-2-Clause
"""The judge of tests and proofs, on one block: what it lets pass, what it notices, and with which of the two."""

import sys

import pytest

from tb import toolchain
from tb.mutate import mutants
from tb.mutate.blocks import BLOCKS

BATCH, = (block for block in BLOCKS if block.name == "batch")
STUCK = "-mode const0 -module dut -cell $43 -port Q -portbit 13"
HARMLESS = "-mode const0 -module dut -cell $procmux$1000010 -port B -portbit 0"


@pytest.fixture(scope="module")
def batch():
    return mutants.build(toolchain.to_rtlil(BATCH.make()), BATCH.part, count=12)


def failing(directory, number):
    sys.path.insert(0, str(toolchain.ROOT / "tb" / "rtl"))
    import test_classifier
    return mutants.noticed_by_tests(directory, number, [(test_classifier, BATCH.suites[0].tests, {})])


def test_without_a_mutant_nothing_fails(batch):
    assert failing(batch, 0) is None


def test_most_mutants_fail_a_test(batch):
    how = mutants.listed(batch)
    assert sorted(how) == list(range(1, 13)) and len(set(how.values())) == 12
    assert sum(failing(batch, number) is not None for number in how) >= 7


def test_a_bit_that_no_simulation_counts_up_to_is_the_proof_s_to_notice(batch):
    proof, = BATCH.proofs
    assert mutants.noticed_by_proof(proof, batch, BATCH.part, STUCK)


def test_equivalence_is_told_from_difference(batch):
    """A value at reset that is 0 stays what it is when it is stuck at 0."""
    assert mutants.is_equivalent(batch, BATCH.part, HARMLESS)
    assert not mutants.is_equivalent(batch, BATCH.part, STUCK)
