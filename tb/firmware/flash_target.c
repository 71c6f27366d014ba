/* SPDX-License-Identifier: BSD-2-Clause */
/* A program for the soft core instead of the application: uses the flash and says what came of it, a letter a step. */
#include <string.h>

#include "hal/flash_map.h"
#include "hal/serial.h"
#include "hal/watchdog.h"
#include "main.h"
#include "regs.h"

enum { PLACE = 0x6000f3, SIZE = 700 };

static uint8_t bytes[SIZE], back[SIZE];
static unsigned polls;

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

static void say(bool yes)
{
    serial_say(yes ? "y" : "n");
}

static void poll(void)
{
    polls++;
    watchdog_kick();
}

int main(void)
{
    serial_init(CLOCK_HZ, 115200);
    serial_say("begin ");
    for (unsigned n = 0; n < SIZE; n++)
        bytes[n] = (uint8_t)(n * 7 + n / 256);
    flash_on_wait(poll);
    say(flash_present());
    say(flash_erase(PLACE) && polls > 0);
    say(flash_program(PLACE, bytes, SIZE));
    say(flash_read(PLACE, back, SIZE));
    say(memcmp(bytes, back, SIZE) == 0);
    say(flash_erase(FLASH_MAP_COUNTER - 1));
    say(flash_erase(FLASH_MAP_COUNTER));
    say(flash_erase(FLASH_BYTES - 1));
    serial_say(" end\r\n");
    for (;;)
        poll();
}
