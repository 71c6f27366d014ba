/* SPDX-License-Identifier: BSD-2-Clause */
/* A program for the soft core instead of the application: says the digest of the number vectors. */
#include <stdint.h>

#include "hal/serial.h"
#include "main.h"
#include "number_vectors.h"
#include "regs.h"

static void say_hex(uint32_t value)
{
    char text[] = "00000000\r\n";

    for (int i = 0; i < 8; i++)
        text[7 - i] = "0123456789abcdef"[value >> (4 * i) & 0xf];
    serial_say(text);
}

void main_interrupt(void)
{
}

void main_trap(uint32_t cause, uint32_t at, uint32_t value)
{
    (void)cause;
    (void)at;
    (void)value;
    serial_say("trap\r\n");
    for (;;)
        ;
}

int main(void)
{
    serial_init(CLOCK_HZ, 115200);
    say_hex(number_digest(NUMBER_TARGET_COUNT));
    for (;;)
        __asm__ volatile("wfi");
}
