// SPDX-License-Identifier: BSD-2-Clause
// Block memory DP16KD of the ECP5: 18 kbit, two ports; and the same as one port to write and one to read 36 bits.
//
// Sources: Lattice FPGA-TN-02204, "ECP5 and ECP5-5G Memory Usage Guide", on true dual-port RAM (RAM_DP_TRUE),
// pseudo dual-port RAM (RAM_DP), byte enable, and the attributes of the EBR primitives.  Which bits of INITVAL are
// which word, and that a 36-bit read leaves by DOA (bits 17:0) and DOB (35:18), is how yosys fills it
// (share/lattice/brams_map_16kd.v).  Compared with inferred RTL by tb/gates/test_models.py.
//
// Simulation may give a block with a NUMBER other contents than INITVAL, so that new firmware compiles nothing:
// +bram=<directory> has them in <NUMBER>.hex, 1024 words of 18 bits.
//
// Models what yosys makes of our designs and stops the simulation at anything else: no output register, no reset,
// no chip select, ports on one clock (or one of them without any), widths 1, 2, 4, 9, 18, or 36 on both.
//
// Words are 18 bits.  A port of width 18 or 36 has byte enables in the low address bits.  What is written shows at
// that port as the word before (READBEFOREWRITE), or not at all (NORMAL).  A bit read by one port on the clock on
// which the other writes it is undefined; here it reads as the complement of what it was.
module DP16KD (
  input DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4,
    DIA3, DIA2, DIA1, DIA0,
  input ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0,
  input CEA, OCEA, CLKA, WEA, RSTA, CSA2, CSA1, CSA0,
  output DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5,
    DOA4, DOA3, DOA2, DOA1, DOA0,
  input DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4,
    DIB3, DIB2, DIB1, DIB0,
  input ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0,
  input CEB, OCEB, CLKB, WEB, RSTB, CSB2, CSB1, CSB0,
  output DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5,
    DOB4, DOB3, DOB2, DOB1, DOB0
);
  parameter DATA_WIDTH_A = 18, DATA_WIDTH_B = 18;
  parameter WRITEMODE_A = "NORMAL", WRITEMODE_B = "NORMAL";
  parameter REGMODE_A = "NOREG", REGMODE_B = "NOREG";
  parameter CSDECODE_A = "0b000", CSDECODE_B = "0b000";
  parameter CLKAMUX = "CLKA", CLKBMUX = "CLKB";
  parameter NUMBER = -1;
  parameter GSR = "ENABLED", RESETMODE = "SYNC", ASYNC_RESET_RELEASE = "SYNC";
  parameter [319:0] INITVAL_00 = 0, INITVAL_01 = 0, INITVAL_02 = 0, INITVAL_03 = 0;
  parameter [319:0] INITVAL_04 = 0, INITVAL_05 = 0, INITVAL_06 = 0, INITVAL_07 = 0;
  parameter [319:0] INITVAL_08 = 0, INITVAL_09 = 0, INITVAL_0A = 0, INITVAL_0B = 0;
  parameter [319:0] INITVAL_0C = 0, INITVAL_0D = 0, INITVAL_0E = 0, INITVAL_0F = 0;
  parameter [319:0] INITVAL_10 = 0, INITVAL_11 = 0, INITVAL_12 = 0, INITVAL_13 = 0;
  parameter [319:0] INITVAL_14 = 0, INITVAL_15 = 0, INITVAL_16 = 0, INITVAL_17 = 0;
  parameter [319:0] INITVAL_18 = 0, INITVAL_19 = 0, INITVAL_1A = 0, INITVAL_1B = 0;
  parameter [319:0] INITVAL_1C = 0, INITVAL_1D = 0, INITVAL_1E = 0, INITVAL_1F = 0;
  parameter [319:0] INITVAL_20 = 0, INITVAL_21 = 0, INITVAL_22 = 0, INITVAL_23 = 0;
  parameter [319:0] INITVAL_24 = 0, INITVAL_25 = 0, INITVAL_26 = 0, INITVAL_27 = 0;
  parameter [319:0] INITVAL_28 = 0, INITVAL_29 = 0, INITVAL_2A = 0, INITVAL_2B = 0;
  parameter [319:0] INITVAL_2C = 0, INITVAL_2D = 0, INITVAL_2E = 0, INITVAL_2F = 0;
  parameter [319:0] INITVAL_30 = 0, INITVAL_31 = 0, INITVAL_32 = 0, INITVAL_33 = 0;
  parameter [319:0] INITVAL_34 = 0, INITVAL_35 = 0, INITVAL_36 = 0, INITVAL_37 = 0;
  parameter [319:0] INITVAL_38 = 0, INITVAL_39 = 0, INITVAL_3A = 0, INITVAL_3B = 0;
  parameter [319:0] INITVAL_3C = 0, INITVAL_3D = 0, INITVAL_3E = 0, INITVAL_3F = 0;

  localparam PSEUDO = DATA_WIDTH_A == 36;           // A writes, B reads
  localparam [64*320-1:0] CONTENTS = {
    INITVAL_3F, INITVAL_3E, INITVAL_3D, INITVAL_3C, INITVAL_3B, INITVAL_3A, INITVAL_39, INITVAL_38,
    INITVAL_37, INITVAL_36, INITVAL_35, INITVAL_34, INITVAL_33, INITVAL_32, INITVAL_31, INITVAL_30,
    INITVAL_2F, INITVAL_2E, INITVAL_2D, INITVAL_2C, INITVAL_2B, INITVAL_2A, INITVAL_29, INITVAL_28,
    INITVAL_27, INITVAL_26, INITVAL_25, INITVAL_24, INITVAL_23, INITVAL_22, INITVAL_21, INITVAL_20,
    INITVAL_1F, INITVAL_1E, INITVAL_1D, INITVAL_1C, INITVAL_1B, INITVAL_1A, INITVAL_19, INITVAL_18,
    INITVAL_17, INITVAL_16, INITVAL_15, INITVAL_14, INITVAL_13, INITVAL_12, INITVAL_11, INITVAL_10,
    INITVAL_0F, INITVAL_0E, INITVAL_0D, INITVAL_0C, INITVAL_0B, INITVAL_0A, INITVAL_09, INITVAL_08,
    INITVAL_07, INITVAL_06, INITVAL_05, INITVAL_04, INITVAL_03, INITVAL_02, INITVAL_01, INITVAL_00};

  wire [13:0] address_a = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0};
  wire [13:0] address_b = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0};
  wire [17:0] data_a = {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4,
    DIA3, DIA2, DIA1, DIA0};
  wire [17:0] data_b = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4,
    DIB3, DIB2, DIB1, DIB0};

  // A port's bits of its 18-bit word: how far up they start, and which are written.
  function [4:0] first(input integer width, input [13:0] address);
    case (width)
      1: first = 9 * address[3] + address[2:0];
      2: first = 9 * address[3] + 2 * address[2:1];
      4: first = 9 * address[3] + 4 * address[2];
      9: first = 9 * address[3];
      default: first = 0;
    endcase
  endfunction

  function [17:0] bits(input integer width, input [13:0] address);
    bits = width >= 18 ? 18'h3ffff : ((18'd1 << width) - 18'd1) << first(width, address);
  endfunction

  function [17:0] written(input integer width, input [13:0] address);
    written = width >= 18 ? {{9{address[1]}}, {9{address[0]}}} : bits(width, address);
  endfunction

  reg [17:0] words [0:1023];
  reg [17:0] out_a = 0, out_b = 0;                  // a word, of which the port shows its bits
  reg [4:0] first_a = 0, first_b = 0;
  assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4,
    DOA3, DOA2, DOA1, DOA0} = out_a >> first_a;
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4,
    DOB3, DOB2, DOB1, DOB0} = out_b >> first_b;

  wire [9:0] row_a = address_a[13:4], row_b = address_b[13:4];
  wire writes_a = CLKA & CEA & WEA, writes_b = CLKB & CEB & WEB;
  wire [17:0] mask_a = writes_a ? written(DATA_WIDTH_A, address_a) : 18'd0;
  wire [17:0] mask_b = writes_b ? written(DATA_WIDTH_B, address_b) : 18'd0;
  // Of a 36-bit write, and of the word a 36-bit read takes.
  wire [35:0] mask_pair = {{9{address_a[3]}}, {9{address_a[2]}}, {9{address_a[1]}}, {9{address_a[0]}}};
  wire [35:0] clash_pair = row_a[9:1] == row_b[9:1] && CLKA & CEA & WEA ? mask_pair : 36'd0;

  task write(input [9:0] row, input [17:0] data, input [17:0] mask);
    words[row] = (words[row] & ~mask) | (data & mask);
  endtask

  wire clock = CLKA | CLKB;
  reg seen_a = 0, seen_b = 0;
  generate
    if (PSEUDO) begin
      always @(posedge clock) begin
        if (CLKB & CEB) begin
          out_a <= words[{row_b[9:1], 1'b0}] ^ clash_pair[17:0];
          out_b <= words[{row_b[9:1], 1'b1}] ^ clash_pair[35:18];
        end
        if (writes_a) begin
          write({row_a[9:1], 1'b0}, data_a, mask_pair[17:0]);
          write({row_a[9:1], 1'b1}, data_b, mask_pair[35:18]);
        end
      end
    end else begin
      always @(posedge clock) begin
        if (CLKA & CEA & (~WEA | (WRITEMODE_A == "READBEFOREWRITE"))) begin
          out_a <= words[row_a] ^ (row_a == row_b ? mask_b : 18'd0);
          first_a <= first(DATA_WIDTH_A, address_a);
        end
        if (CLKB & CEB & (~WEB | (WRITEMODE_B == "READBEFOREWRITE"))) begin
          out_b <= words[row_b] ^ (row_a == row_b ? mask_a : 18'd0);
          first_b <= first(DATA_WIDTH_B, address_b);
        end
        if (writes_a) write(row_a, data_a << first(DATA_WIDTH_A, address_a), mask_a);
        if (writes_b) write(row_b, data_b << first(DATA_WIDTH_B, address_b), mask_b);
        if (row_a == row_b && (mask_a & mask_b) != 0) $fatal(1, "%m: both ports write the same bits");
      end
    end
  endgenerate

  always @(posedge clock) begin
    seen_a <= seen_a | CLKA;
    seen_b <= seen_b | CLKB;
    if (seen_a & seen_b & (CLKA != CLKB)) $fatal(1, "%m: ports on different clocks are not modelled");
    if (RSTA | RSTB) $fatal(1, "%m: resets are not modelled");
    if (CSA2 | CSA1 | CSA0 | CSB2 | CSB1 | CSB0) $fatal(1, "%m: chip selects are not modelled");
  end

  function known(input integer width);
    known = width == 1 || width == 2 || width == 4 || width == 9 || width == 18;
  endfunction

  integer i;
  string directory;
  initial begin
    for (i = 0; i < 1024; i = i + 1) words[i] = CONTENTS[20*i +: 18];
    if (NUMBER >= 0 && $value$plusargs("bram=%s", directory))
      $readmemh($sformatf("%s/%0d.hex", directory, NUMBER), words);
    if (!(PSEUDO ? DATA_WIDTH_B == 36 : known(DATA_WIDTH_A) && known(DATA_WIDTH_B)))
      $fatal(1, "%m: widths %0d and %0d are not modelled", DATA_WIDTH_A, DATA_WIDTH_B);
    if ((WRITEMODE_A != "NORMAL" && WRITEMODE_A != "READBEFOREWRITE") ||
        (WRITEMODE_B != "NORMAL" && WRITEMODE_B != "READBEFOREWRITE"))
      $fatal(1, "%m: write modes %s and %s are not modelled", WRITEMODE_A, WRITEMODE_B);
    if (REGMODE_A != "NOREG" || REGMODE_B != "NOREG") $fatal(1, "%m: output registers are not modelled");
    if (CSDECODE_A != "0b000" || CSDECODE_B != "0b000") $fatal(1, "%m: chip selects are not modelled");
    if (CLKAMUX != "CLKA" || CLKBMUX != "CLKB") $fatal(1, "%m: falling edges are not modelled");
  end
endmodule
