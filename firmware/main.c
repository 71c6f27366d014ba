/* SPDX-License-Identifier: BSD-2-Clause */
/** The target's program: run the application, sleep when there is nothing to do. */
#include <stdint.h>

#include "hal/bus.h"
#include "hal/interrupts.h"
#include "hal/pwm.h"
#include "hal/serial.h"
#include "main.h"
#include "modules/application.h"

/* What mcause says of an interrupt, with the number of the line. */
#define CAUSE_BUS_WRITE 0x80000004u

static void stay(void)
{
    for (;;)
        __asm__ volatile("wfi");
}

static void say_hex(uint32_t value)
{
    char text[] = " 0x00000000";

    for (int i = 0; i < 8; i++)
        text[10 - i] = "0123456789abcdef"[value >> (4 * i) & 0xf];
    serial_say(text);
}

void main_trap(uint32_t cause, uint32_t at, uint32_t value)
{
    pwm_enable(0);
    serial_say("\r\nAbbe: stopped by a fault, cause, place, value:");
    say_hex(cause);
    say_hex(at);
    say_hex(value);
    serial_say("\r\n");
    stay();
}

void main_interrupt(void)
{
    if ((interrupts_pending() & INTERRUPTS_BUS) != 0)
        main_trap(CAUSE_BUS_WRITE, 0, bus_take_fault());
    application_interrupt();
}

int main(void)
{
    if (!application_init())
        stay();
    for (;;) {
        application_poll();
        do
            interrupts_sleep_unless(application_busy);
        while (!application_busy());
    }
}
