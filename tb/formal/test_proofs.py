# SPDX-License-Identifier: BSD-2-Clause
"""The fast proofs, as tests; ``python -m tb.formal`` runs them all."""

import pytest

from tb.formal.__main__ import proofs
from tb.formal.proof import run


@pytest.mark.parametrize("proof", [p for p in proofs() if p.fast], ids=lambda p: p.name())
def test_proof(proof):
    assert run(proof)
