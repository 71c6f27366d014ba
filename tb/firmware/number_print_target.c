/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Prints a million formatted numbers, and what is parsed from as many numerals: a line each, "text bits". Built for the
 * host, and of the very objects of the target for qemu-riscv32 (linux.S): python -m tb.firmware.numbers compares.
 */
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "core/number.h"
#include "number_vectors.h"

enum { COUNT = 1000000, LINE = NUMBER_TEXT_MAX + 1 + 16 + 1 };

static char lines[1 << 15];
static size_t used;

static void flush(void)
{
    for (size_t at = 0; at < used;) {
        ssize_t written = write(1, lines + at, used - at);

        if (written <= 0)
            _exit(1);
        at += (size_t)written;
    }
    used = 0;
}

static void print(const char *text, size_t length, double read)
{
    uint64_t bits;

    if (used + LINE > sizeof lines)
        flush();
    memcpy(lines + used, text, length);
    used += length;
    lines[used++] = ' ';
    memcpy(&bits, &read, sizeof bits);
    for (int shift = 60; shift >= 0; shift -= 4)
        lines[used++] = "0123456789abcdef"[bits >> shift & 15];
    lines[used++] = '\n';
}

int main(void)
{
    number_each(COUNT, print);
    flush();
    return 0;
}
