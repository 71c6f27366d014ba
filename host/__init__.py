# SPDX-License-Identifier: BSD-2-Clause
"""Tools for the host computer."""
