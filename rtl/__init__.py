# SPDX-License-Identifier: BSD-2-Clause
"""Gateware of Abbe: one block per file, its logic and its registers together.

A block knows its pins and its registers; it knows no address, no board and no other block's registers.
"""
