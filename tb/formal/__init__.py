# SPDX-License-Identifier: BSD-2-Clause
"""Formal proofs of the gateware: ``python -m tb.formal [name...]``, and the fast ones in ``make test``.

A proof is a class (:class:`tb.formal.proof.Proof`) in one of the files named in ``tb/formal/__main__.py``:
a harness around a block, what must hold, what must be reachable, and at least one bug that must be found.
"""
