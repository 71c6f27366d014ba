/* SPDX-License-Identifier: BSD-2-Clause */
#include "nor_flash.h"

#include <string.h>

#include "hal/flash_map.h"
#include "random.h"

uint8_t nor_flash[NOR_FLASH_BYTES];

static unsigned long changes, changes_left;
static bool down;
static uint32_t guard;

void nor_flash_reset(void)
{
    memset(nor_flash, 0xff, sizeof nor_flash);
    changes = 0;
    nor_flash_power_up();
}

void nor_flash_power_up(void)
{
    down = false;
    guard = FLASH_MAP_COUNTER;
    changes_left = (unsigned long)-1;
}

void nor_flash_cut_after(unsigned long count)
{
    changes = 0;
    changes_left = count;
}

unsigned long nor_flash_changes(void)
{
    return changes;
}

/* Bits of one byte that a change is to clear or set; what a cut leaves of it. */
static void change(uint8_t *byte, uint8_t to, bool whole)
{
    const uint8_t moved = (uint8_t)(*byte ^ to);

    *byte = whole ? to : (uint8_t)(*byte ^ (moved & random_below(256)));
}

/* Whether the next change is done; false: it is the one that is cut. */
static bool power_lasts(void)
{
    if (changes_left == 0) {
        down = true;
        return false;
    }
    changes_left--;
    changes++;
    return true;
}

static bool is_inside(uint32_t address, size_t size)
{
    return !down && address < NOR_FLASH_BYTES && size <= NOR_FLASH_BYTES - address;
}

bool flash_present(void)
{
    return true;
}

bool flash_read(uint32_t address, void *to, size_t size)
{
    if (!is_inside(address, size))
        return false;
    memcpy(to, nor_flash + address, size);
    return true;
}

bool flash_program(uint32_t address, const void *from, size_t size)
{
    if (!is_inside(address, size) || address < guard)
        return false;
    for (size_t n = 0; n < size; n++) {
        uint8_t *byte = &nor_flash[address + n];

        change(byte, *byte & ((const uint8_t *)from)[n], power_lasts());
        if (down)
            return false;
    }
    return true;
}

bool flash_erase(uint32_t address)
{
    const uint32_t start = address / FLASH_SECTOR * FLASH_SECTOR;
    bool whole;

    if (!is_inside(address, 1) || address < guard)
        return false;
    whole = power_lasts();
    for (uint32_t n = 0; n < FLASH_SECTOR; n++)
        change(&nor_flash[start + n], 0xff, whole);
    return whole;
}

void flash_lock(void)
{
    guard = FLASH_MAP_GUARDED_END;
}

void flash_on_wait(void (*poll)(void))
{
    (void)poll;
}
