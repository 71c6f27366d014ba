# SPDX-License-Identifier: BSD-2-Clause
"""How much of a wrong timing block do its tests and proofs notice?  See :mod:`tb.mutate.__main__`."""
