// SPDX-License-Identifier: BSD-2-Clause
// PLL EHXPLLL of the ECP5 with feedback from CLKOP, and clock gate DCCA.  Needs delays (verilator --timing).
//
// Source: Lattice FPGA-TN-02200, "ECP5 and ECP5-5G sysCLOCK PLL/DLL Design and Usage Guide": dividers, phase,
// feedback, dynamic clock control.  Frequency limits: Lattice FPGA-DS-02012, sysCLOCK PLL timing.
//
// VCO = CLKI * CLKFB_DIV * CLKOP_DIV; output n = VCO / its divider, half of the time high, and rises
// with CLKI (CPHASE = divider - 1, FPHASE = 0).  It starts after one period of CLKI, to measure
// it, and LOCK rises LOCK_TURNS periods later: a real PLL takes up to 15 ms, at frequencies nobody
// promises.  CLKI more than half a period late, or at another period: outputs and LOCK fall, and it starts anew.
// Anything else that the primitive can do stops the simulation.
module EHXPLLL (
  input CLKI, CLKFB, RST, STDBY, PLLWAKESYNC, ENCLKOP, ENCLKOS,
  input PHASESEL0, PHASESEL1, PHASEDIR, PHASESTEP, PHASELOADREG,
  output reg CLKOP, output reg CLKOS, output reg LOCK
);
  parameter CLKI_DIV = 1, CLKFB_DIV = 1, CLKOP_DIV = 8, CLKOS_DIV = 8;
  parameter CLKOP_CPHASE = 0, CLKOS_CPHASE = 0, CLKOP_FPHASE = 0, CLKOS_FPHASE = 0;
  parameter CLKOP_ENABLE = "ENABLED", CLKOS_ENABLE = "DISABLED";
  parameter CLKOS2_ENABLE = "DISABLED", CLKOS3_ENABLE = "DISABLED";
  parameter FEEDBK_PATH = "CLKOP", OUTDIVIDER_MUXA = "DIVA", OUTDIVIDER_MUXB = "DIVB";
  parameter PLLRST_ENA = "DISABLED", INTFB_WAKE = "DISABLED", STDBY_ENABLE = "DISABLED";
  parameter DPHASE_SOURCE = "DISABLED";

  localparam HALVES = 2 * CLKFB_DIV * CLKOP_DIV;    // half periods of the VCO in a period of CLKI
  localparam LOCK_TURNS = 20;

  realtime turn, start;
  integer turns, half, op, os;
  reg lost;

  task check(input bad, input [8*40-1:0] what);
    if (bad) $fatal(1, "%m: %0s is not modelled", what);
  endtask

  function out_of(input real ps, input real least_mhz, input real most_mhz);
    out_of = 1e6 / ps < least_mhz * 0.9999 || 1e6 / ps > most_mhz * 1.0001;
  endfunction

  initial begin
    {CLKOP, CLKOS, LOCK} = 0;
    check(FEEDBK_PATH != "CLKOP", "feedback from elsewhere");
    check(CLKI_DIV != 1, "a divider of the input");
    check(CLKOP_ENABLE != "ENABLED", "CLKOP disabled");
    check(CLKOS2_ENABLE != "DISABLED" || CLKOS3_ENABLE != "DISABLED", "a third output");
    check(CLKOP_CPHASE != CLKOP_DIV - 1 || CLKOP_FPHASE != 0, "a phase of CLKOP");
    check(CLKOS_ENABLE == "ENABLED" && (CLKOS_CPHASE != CLKOS_DIV - 1 || CLKOS_FPHASE != 0), "a phase of CLKOS");
    check(PLLRST_ENA != "DISABLED" || STDBY_ENABLE != "DISABLED" || INTFB_WAKE != "DISABLED", "reset or standby");
    check(DPHASE_SOURCE != "DISABLED", "dynamic phase");
    check(OUTDIVIDER_MUXA != "DIVA" || OUTDIVIDER_MUXB != "DIVB", "an output without divider");

    forever begin
      {CLKOP, CLKOS, LOCK} = 0;
      turns = 0;
      @(posedge CLKI) start = $realtime;
      @(posedge CLKI) turn = $realtime - start;
      if (out_of(turn, 10, 400) || out_of(2 * turn / HALVES, 400, 800))
        $fatal(1, "%m: a comparison every %0t is out of the range of the PLL", turn);
      op = 0;
      os = 0;
      lost = 0;
      while (!lost) begin
        start = $realtime;
        for (half = 0; half < HALVES; half = half + 1) begin
          CLKOP = op < CLKOP_DIV;
          CLKOS = CLKOS_ENABLE == "ENABLED" && os < CLKOS_DIV;
          op = op == 2 * CLKOP_DIV - 1 ? 0 : op + 1;
          os = os == 2 * CLKOS_DIV - 1 ? 0 : os + 1;
          if (half < HALVES - 1) #(start + turn * (half + 1) / HALVES - $realtime);
          if (CLKFB !== CLKOP) $fatal(1, "%m: CLKFB is not CLKOP");
        end
        turns = turns + 1;
        if (turns == LOCK_TURNS) LOCK = 1;
        // The last half period ends with the next comparison.
        fork
          @(posedge CLKI);
          #(turn / 2) lost = 1;
        join_any
        disable fork;
        if ($realtime - start > 1.01 * turn || $realtime - start < 0.99 * turn) lost = 1;
      end
    end
  end
endmodule

// The clock passes from the fall of CLKI at which CE is high to that at which it is low.
module DCCA (input CLKI, CE, output CLKO);
  reg open = 0;
  always @(negedge CLKI) open <= CE;
  assign CLKO = CLKI & open;
endmodule
