/* SPDX-License-Identifier: BSD-2-Clause */
#include "chip.h"

#include <string.h>

static struct chip *fitted;
static void (*on_step)(void);
static void (*on_wait)(void);
static int operations_left = -1;

void chip_deliver(struct chip *chip, uint32_t first, uint32_t size)
{
    memset(chip->bytes + first, 0xff, size);
    nor_init(&chip->nor, chip->bytes);
}

void chip_fit(struct chip *chip)
{
    fitted = chip;
    operations_left = -1;
    if (chip != NULL)
        chip->nor.bytes = chip->bytes;
}

void chip_on_step(void (*step)(void))
{
    on_step = step;
}

void chip_wear_out(int operations)
{
    operations_left = operations;
}

static void step(void)
{
    fitted->steps++;
    if (on_step != NULL)
        on_step();
    nor_step(&fitted->nor);
}

void chip_cut(struct chip *chip, uint32_t seed)
{
    chip->nor.bytes = chip->bytes;
    nor_cut(&chip->nor, seed);
}

/* --- hal/flash.h -------------------------------------------------------------------------------- */

static bool refuses(uint32_t address, size_t size)
{
    return fitted == NULL || address > NOR_BYTES || size > NOR_BYTES - address;
}

static bool worn_out(void)
{
    return operations_left >= 0 && operations_left-- <= 0;
}

static void wait(void)
{
    if (on_wait != NULL)
        on_wait();
}

bool flash_present(void)
{
    return fitted != NULL;
}

bool flash_read(uint32_t address, void *to, size_t size)
{
    if (refuses(address, size))
        return false;
    fitted->reads++;
    fitted->bytes_read += size;
    nor_read(&fitted->nor, address, to, size);
    return true;
}

bool flash_program(uint32_t address, const void *from, size_t size)
{
    const uint8_t *bytes = from;

    if (refuses(address, size))
        return false;
    while (size > 0) {
        const uint32_t room = FLASH_PAGE - address % FLASH_PAGE, part = size < room ? (uint32_t)size : room;

        if (worn_out())
            return false;
        nor_program(&fitted->nor, address, bytes, part);
        while (fitted->nor.work.kind != NOR_RESTS)
            step();
        fitted->pages++;
        wait();
        address += part;
        bytes += part;
        size -= part;
    }
    return true;
}

bool flash_erase(uint32_t address)
{
    if (refuses(address, 1) || worn_out())
        return false;
    nor_erase(&fitted->nor, address);
    while (fitted->nor.work.kind != NOR_RESTS) {
        step();
        wait();
    }
    fitted->erases[address / FLASH_SECTOR]++;
    return true;
}

void flash_lock(void)
{
}

void flash_on_wait(void (*poll)(void))
{
    on_wait = poll;
}
