// SPDX-License-Identifier: BSD-2-Clause
// On-chip memory of 32-bit words with two ports on one clock: a reads, b reads or writes bytes.
//
// Data come out 1 clock after the enable and stay until the next one.  Whoever reads a word on the clock on which
// it is written, by either port, gets the old or the new one: do not use it.  (Promised either, synthesis would
// double the block RAM.)
//
// In simulation the words are loaded at time 0 from the hexadecimal file named by the plusarg FILE (a format such
// as "firmware=%s"); words not in the file are 0.  Synthesis sees block RAM; with the macro INITIALISED, its contents
// are those of the hexadecimal file CONTENTS, found where the tool runs.
module abbe_memory #(
  parameter WORDS = 2048,
  parameter ADDRESS_WIDTH = 11,
  parameter FILE = "boot=%s",
  parameter CONTENTS = "boot.hex"
) (
  input clk,
  input a_enable,
  input [ADDRESS_WIDTH-1:0] a_address,
  output reg [31:0] a_data,
  input b_enable,
  input [3:0] b_write,
  input [ADDRESS_WIDTH-1:0] b_address,
  input [31:0] b_write_data,
  output reg [31:0] b_data
);
  (* no_rw_check *) reg [31:0] words [0:WORDS-1];

  always @(posedge clk)
    if (a_enable) a_data <= words[a_address];

  always @(posedge clk)
    if (b_enable) begin
      if (b_write[0]) words[b_address][7:0] <= b_write_data[7:0];
      if (b_write[1]) words[b_address][15:8] <= b_write_data[15:8];
      if (b_write[2]) words[b_address][23:16] <= b_write_data[23:16];
      if (b_write[3]) words[b_address][31:24] <= b_write_data[31:24];
      b_data <= words[b_address];
    end

`ifndef SYNTHESIS
  integer i;
  string name;
  initial begin
    for (i = 0; i < WORDS; i = i + 1) words[i] = 0;
    if ($value$plusargs(FILE, name)) $readmemh(name, words);
  end
`elsif INITIALISED
  initial $readmemh(CONTENTS, words);
`endif
endmodule
