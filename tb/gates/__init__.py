# SPDX-License-Identifier: BSD-2-Clause
"""Tests on the netlist that goes to the FPGA; see docs/gates.md."""
