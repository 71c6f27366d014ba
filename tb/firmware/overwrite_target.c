/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A program for the soft core that does the worst it can to memory: all words from 0 to behind RAM, itself among them. The
 * loop lives in the instruction cache until it meets the watchdog or what it has written.
 */
#include "hal/serial.h"
#include "hal/watchdog.h"
#include "main.h"
#include "regs.h"

enum { WATCHDOG_MS = 30, END = 0x60000 };

void main_interrupt(void)
{
}

/* Not met: the boot program's memory refuses by an interrupt, which is off. */
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
    serial_say("begin\r\n");
    while (serial_status_tx_idle_get() == 0)
        ;
    watchdog_start(WATCHDOG_MS);
    __asm__ volatile("csrw mie, zero\n"
                     "   li t0, 0\n"
                     "   li t1, %0\n"
                     "   li t2, -1\n"
                     "1: sw t2, 0(t0)\n"
                     "   addi t0, t0, 4\n"
                     "   bltu t0, t1, 1b\n"
                     "2: j 2b\n"
                     :
                     : "i"(END));
    return 0;
}
