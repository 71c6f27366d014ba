/* SPDX-License-Identifier: BSD-2-Clause */
/* This gateware has no flash controller yet: there is no flash. */
#include "hal/flash.h"

bool flash_present(void)
{
    return false;
}

bool flash_read(uint32_t address, void *to, size_t size)
{
    (void)address;
    (void)to;
    (void)size;
    return false;
}

bool flash_program(uint32_t address, const void *from, size_t size)
{
    (void)address;
    (void)from;
    (void)size;
    return false;
}

bool flash_erase(uint32_t address)
{
    (void)address;
    return false;
}

void flash_guard(uint32_t lowest)
{
    (void)lowest;
}

void flash_on_wait(void (*poll)(void))
{
    (void)poll;
}
