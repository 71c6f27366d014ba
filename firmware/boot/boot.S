/* SPDX-License-Identifier: BSD-2-Clause */
/* Reset: the processor starts here, at address 0. */

    .section .boot.start, "ax"
    .globl boot_start
boot_start:
    csrw mie, zero
    csrci mstatus, 8
    la sp, stack_top
    j boot_main
