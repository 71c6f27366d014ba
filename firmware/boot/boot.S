/* SPDX-License-Identifier: BSD-2-Clause */
/* Reset: the processor starts here, at address 0. */

    .section .boot.start, "ax"
    .globl boot_start
boot_start:
    csrw mie, zero
    csrci mstatus, 8
    la sp, stack_top
    la t0, trap_entry
    csrw mtvec, t0
    la t1, bss_start
    la t2, bss_end
1:  bgeu t1, t2, 2f
    sw zero, 0(t1)
    sw zero, 4(t1)
    sw zero, 8(t1)
    sw zero, 12(t1)
    addi t1, t1, 16
    j 1b
2:  j boot_main

    .balign 4
trap_entry:
    la sp, stack_top
    j boot_trap

    /* Instructions are fetched past the data cache and from a cache of their own. */
    .globl boot_run
boot_run:
    fence.i
    jr a0
