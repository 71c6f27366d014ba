/* SPDX-License-Identifier: BSD-2-Clause */
#include "chip.h"

#include <string.h>

static struct chip *fitted;
static void (*on_step)(void);
static void (*on_wait)(void);
static int operations_left = -1;

void chip_fit(struct chip *chip)
{
    fitted = chip;
    operations_left = -1;
}

void chip_on_step(void (*step)(void))
{
    on_step = step;
}

void chip_wear_out(int operations)
{
    operations_left = operations;
}

uint8_t chip_byte(const struct chip *chip, uint32_t address)
{
    return (uint8_t)~chip->zeros[address];
}

/* xorshift32 (Marsaglia 2003), seeded at the first use. */
static uint32_t random_below(struct chip *chip, uint32_t limit)
{
    uint32_t x = chip->random != 0 ? chip->random : 1;

    x ^= x << 13;
    x ^= x >> 17;
    x ^= x << 5;
    chip->random = x;
    return (x >> 8) % limit;
}

/* A byte in which each bit is 1 with a probability, in 256ths. */
static uint8_t random_bits(struct chip *chip, uint32_t share)
{
    uint8_t bits = 0;

    for (unsigned bit = 0; bit < 8; bit++)
        bits |= (uint8_t)((random_below(chip, 256) < share) << bit);
    return bits;
}

static void step(void)
{
    fitted->steps++;
    if (on_step != NULL)
        on_step();
}

/* --- What a cut leaves ------------------------------------------------------------------------- */

static void cut_page(struct chip *chip)
{
    struct chip_work *work = &chip->work;
    const bool in_order = random_below(chip, 2) == 0;
    const uint32_t share = 256 * (work->done + 1) / (work->size + 1);

    for (uint32_t n = 0; n < work->size; n++) {
        const uint8_t set = in_order ? n < work->done ? 0xff : n > work->done ? 0 : random_bits(chip, 128)
                                     : random_bits(chip, share);

        chip->zeros[work->address + n] = work->before[n] | (work->zeros[n] & set);
    }
}

static void cut_erase(struct chip *chip)
{
    static const struct {
        uint8_t least, most;
    } shares[] = {{1, 8}, {30, 220}, {248, 255}};
    const struct chip_work *work = &chip->work;

    chip->unstable[work->address / FLASH_SECTOR] =
        (uint8_t)(shares[work->done].least +
                  random_below(chip, shares[work->done].most - shares[work->done].least + 1u));
}

void chip_cut(struct chip *chip, uint32_t seed)
{
    chip->random = seed * 2654435761u | 1; /* small seeds far apart */
    if (chip->work.kind == CHIP_PROGRAMS)
        cut_page(chip);
    else if (chip->work.kind == CHIP_ERASES)
        cut_erase(chip);
    chip->work.kind = CHIP_RESTS;
}

/* --- hal/flash.h -------------------------------------------------------------------------------- */

static bool refuses(uint32_t address, size_t size)
{
    return fitted == NULL || address > CHIP_SIZE || size > CHIP_SIZE - address;
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
    uint8_t *bytes = to;

    if (refuses(address, size))
        return false;
    fitted->reads++;
    fitted->bytes_read += size;
    for (size_t n = 0; n < size; n++) {
        const uint8_t share = fitted->unstable[(address + n) / FLASH_SECTOR];

        bytes[n] = (uint8_t)~fitted->zeros[address + n];
        if (share != 0)
            bytes[n] |= random_bits(fitted, share);
    }
    return true;
}

static void program_page(uint32_t address, const uint8_t *from, uint32_t size)
{
    struct chip_work *work = &fitted->work;

    *work = (struct chip_work){.kind = CHIP_PROGRAMS, .address = address, .size = size};
    memcpy(work->before, fitted->zeros + address, size);
    for (uint32_t n = 0; n < size; n++)
        work->zeros[n] = (uint8_t)~from[n];
    for (; work->done < size; work->done++) {
        step();
        fitted->zeros[address + work->done] |= work->zeros[work->done];
    }
    work->kind = CHIP_RESTS;
    fitted->pages++;
    wait();
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
        program_page(address, bytes, part);
        address += part;
        bytes += part;
        size -= part;
    }
    return true;
}

bool flash_erase(uint32_t address)
{
    const uint32_t sector = address / FLASH_SECTOR;
    struct chip_work *work;

    if (refuses(address, 1) || worn_out())
        return false;
    work = &fitted->work;
    *work = (struct chip_work){.kind = CHIP_ERASES, .address = sector * FLASH_SECTOR, .size = 3};
    for (; work->done < work->size; work->done++) {
        step();
        wait();
    }
    memset(fitted->zeros + work->address, 0, FLASH_SECTOR);
    fitted->unstable[sector] = 0;
    fitted->erases[sector]++;
    work->kind = CHIP_RESTS;
    return true;
}

void flash_lock(void)
{
}

void flash_on_wait(void (*poll)(void))
{
    on_wait = poll;
}
