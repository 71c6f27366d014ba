/* SPDX-License-Identifier: BSD-2-Clause */
#include "nor_flash.h"

#include <string.h>

#include "../board/nor.h"
#include "hal/flash_map.h"
#include "random.h"

uint8_t nor_flash[NOR_FLASH_BYTES];

static struct nor nor = {.bytes = nor_flash, .random = 1};
static unsigned long changes, changes_left;
static bool down;
static uint32_t guard;

void nor_flash_reset(void)
{
    memset(nor_flash, 0xff, sizeof nor_flash);
    nor_init(&nor, nor_flash);
    changes = 0;
    nor_flash_power_up();
}

void nor_flash_put(const uint8_t *contents)
{
    nor_flash_reset();
    memcpy(nor_flash, contents, sizeof nor_flash);
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

/* Whether the next change is done; false: it is the one that is cut. */
static bool power_lasts(void)
{
    if (changes_left == 0) {
        down = true;
        nor_cut(&nor, random_below(UINT32_MAX));
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
    nor_read(&nor, address, to, size);
    return true;
}

bool flash_program(uint32_t address, const void *from, size_t size)
{
    const uint8_t *bytes = from;

    if (!is_inside(address, size) || address < guard)
        return false;
    while (size > 0) {
        const uint32_t room = FLASH_PAGE - address % FLASH_PAGE, part = size < room ? (uint32_t)size : room;

        nor_program(&nor, address, bytes, part);
        while (nor.work.kind != NOR_RESTS && power_lasts())
            nor_step(&nor);
        if (down)
            return false;
        address += part;
        bytes += part;
        size -= part;
    }
    return true;
}

bool flash_erase(uint32_t address)
{
    if (!is_inside(address, 1) || address < guard)
        return false;
    nor_erase(&nor, address);
    /* The moment of a cut: any. */
    for (uint32_t moment = random_below(NOR_ERASE_STEPS); moment > 0; moment--)
        nor_step(&nor);
    if (!power_lasts())
        return false;
    while (nor.work.kind != NOR_RESTS)
        nor_step(&nor);
    return true;
}

void flash_lock(void)
{
    guard = FLASH_MAP_GUARDED_END;
}

void flash_on_wait(void (*poll)(void))
{
    (void)poll;
}
