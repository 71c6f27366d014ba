# SPDX-License-Identifier: BSD-2-Clause
"""Formal proofs of the gateware: ``python -m tb.formal [name...]``, and the fast ones in ``make test``.

A proof is a class (:class:`tb.formal.proof.Proof`) in a file of this folder, named for its block: a harness
around the block, what must hold, what must be reachable, and at least one bug that must be found.
"""
