// SPDX-License-Identifier: BSD-2-Clause
// Logic, carry, flip-flops and distributed memory of the ECP5, from the share directory of yosys (+incdir).
// cells_sim.v there, which includes the same two files, also declares DP16KD as a black box.
`include "common_sim.vh"
`include "ccu2c_sim.vh"
