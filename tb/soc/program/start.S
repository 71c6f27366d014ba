/* SPDX-License-Identifier: BSD-2-Clause */
/* Reset and traps of the test program. */
    .option norelax
    .section .start, "ax"
    .globl start
start:
    la sp, stack_top
    la t0, trap_entry
    csrw mtvec, t0
    call program
1:  wfi
    j 1b

    .balign 4
    .globl trap_entry
/* The first thing an interrupt does is to note the time: timer.Count at 0xfffff100. */
trap_entry:
    csrw mscratch, t0
    lui t0, 0xfffff
    lw t0, 0x100(t0)
    addi sp, sp, -80
    sw ra, 0(sp)
    sw t0, 4(sp)
    sw t1, 8(sp)
    sw t2, 12(sp)
    sw a0, 16(sp)
    sw a1, 20(sp)
    sw a2, 24(sp)
    sw a3, 28(sp)
    sw a4, 32(sp)
    sw a5, 36(sp)
    sw a6, 40(sp)
    sw a7, 44(sp)
    sw t3, 48(sp)
    sw t4, 52(sp)
    sw t5, 56(sp)
    sw t6, 60(sp)
    csrr a0, mcause
    csrr a1, mepc
    csrr a2, mtval
    mv a3, t0
    mv a4, ra
    call trap
    csrw mepc, a0
    lw ra, 0(sp)
    lw t1, 8(sp)
    lw t2, 12(sp)
    lw a0, 16(sp)
    lw a1, 20(sp)
    lw a2, 24(sp)
    lw a3, 28(sp)
    lw a4, 32(sp)
    lw a5, 36(sp)
    lw a6, 40(sp)
    lw a7, 44(sp)
    lw t3, 48(sp)
    lw t4, 52(sp)
    lw t5, 56(sp)
    lw t6, 60(sp)
    addi sp, sp, 80
    csrr t0, mscratch
    mret
