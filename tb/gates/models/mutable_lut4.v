// SPDX-License-Identifier: BSD-2-Clause
// A LUT4 that is wrong if plusargs say so: "mutant" is its number, "entries" the entries of its table (a hexadecimal
// mask) that are the other way round.  Stands in for the LUTs of a netlist in tb/gates/test_mutants.py, so that every
// mutant is the same simulation.
module MUTABLE_LUT4 #(parameter NUMBER = 0, parameter [15:0] INIT = 0) (input A, B, C, D, output Z);
  reg [15:0] table_;
  assign Z = table_[{D, C, B, A}];

  integer mutant;
  reg [15:0] entries;
  initial begin
    table_ = INIT;
    if ($value$plusargs("mutant=%d", mutant) && mutant == NUMBER && $value$plusargs("entries=%h", entries))
      table_ = INIT ^ entries;
  end
endmodule
