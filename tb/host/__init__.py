# SPDX-License-Identifier: BSD-2-Clause
"""Tests of the tools for the host computer."""
