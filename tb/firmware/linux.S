# SPDX-License-Identifier: BSD-2-Clause
# What a program for the soft core needs to run under qemu-riscv32 instead: Linux calls it here, and has write and exit.
# Numbers of the system calls: the kernel's include/uapi/asm-generic/unistd.h.

    .global _start
_start:
    .option push
    .option norelax
    lla     gp, __global_pointer$
    .option pop
    call    main
    .global _exit           # void _exit(int)
_exit:
    li      a7, 93
    ecall

    .global write           # ssize_t write(int, const void *, size_t)
write:
    li      a7, 64
    ecall
    ret
