/* SPDX-License-Identifier: BSD-2-Clause */
#include "host/interrupts.h"

#include <stddef.h>

#include "hal/interrupts.h"

enum { SERVE_MAX = 16 };

static uint32_t enabled, level, cycles;
static void (*sleep_hook)(void);
static void (*dispatcher)(void);

void interrupts_enable(uint32_t lines)
{
    enabled = lines;
}

uint32_t interrupts_pending(void)
{
    return enabled & level;
}

void interrupts_sleep_unless(bool (*busy)(void))
{
    if (!busy() && sleep_hook != NULL)
        sleep_hook();
    host_interrupts_serve();
}

uint32_t interrupts_cycles(void)
{
    return cycles;
}

void host_interrupts_set(uint32_t lines)
{
    level = lines;
}

void host_interrupts_on_sleep(void (*wait)(void))
{
    sleep_hook = wait;
}

void host_interrupts_dispatch(void (*dispatch)(void))
{
    dispatcher = dispatch;
}

void host_interrupts_serve(void)
{
    for (int i = 0; i < SERVE_MAX && dispatcher != NULL && interrupts_pending() != 0; i++)
        dispatcher();
}

void host_interrupts_set_cycles(uint32_t count)
{
    cycles = count;
}
