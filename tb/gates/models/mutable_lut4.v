// SPDX-License-Identifier: BSD-2-Clause
// A LUT4 with one entry of its table wrong if the plusarg "mutant" says so: entry mutant % 16 of LUT mutant / 16.
// Stands in for the LUTs of a netlist in tb/gates/test_mutants.py, so that every mutant is the same simulation.
module MUTABLE_LUT4 #(parameter NUMBER = 0, parameter [15:0] INIT = 0) (input A, B, C, D, output Z);
  reg [15:0] entries = INIT;
  assign Z = entries[{D, C, B, A}];

  integer mutant;
  initial if ($value$plusargs("mutant=%d", mutant) && mutant / 16 == NUMBER) entries = INIT ^ (16'd1 << mutant % 16);
endmodule
