/* SPDX-License-Identifier: BSD-2-Clause */
#include "boot/counter.h"

#include "boot/sealed.h"
#include "hal/flash_map.h"

enum { SECTORS = 2, FULL = FLASH_SECTOR };

/* One of the two sectors. */
struct record {
    uint32_t largest;
    uint32_t free_at; /* offset of the first number never written, or FULL */
};

static uint32_t sector_address(unsigned sector)
{
    return FLASH_MAP_COUNTER + sector * FLASH_SECTOR;
}

static struct record read_sector(unsigned sector)
{
    struct record record = {0};

    for (; record.free_at < FLASH_SECTOR; record.free_at += SEALED_BYTES) {
        uint8_t bytes[SEALED_BYTES];
        uint32_t value;

        if (!flash_read(sector_address(sector) + record.free_at, bytes, sizeof bytes) ||
            flash_is_erased(bytes, sizeof bytes))
            break;
        if (sealed_read(bytes, &value) && value > record.largest)
            record.largest = value;
    }
    return record;
}

uint32_t counter_read(void)
{
    const uint32_t first = read_sector(0).largest, second = read_sector(1).largest;

    return first > second ? first : second;
}

void counter_raise(uint32_t value)
{
    const struct record records[SECTORS] = {read_sector(0), read_sector(1)};
    unsigned current = records[1].largest > records[0].largest ? 1 : 0;
    uint32_t at = records[current].free_at;
    uint8_t bytes[SEALED_BYTES];

    if (value <= records[current].largest)
        return;
    if (at == FULL) {
        current = 1 - current;
        at = 0;
        if (!flash_erase(sector_address(current)))
            return;
    }
    sealed_write(bytes, value);
    (void)flash_program(sector_address(current) + at, bytes, sizeof bytes);
}
