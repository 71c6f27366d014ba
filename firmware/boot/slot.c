/* SPDX-License-Identifier: BSD-2-Clause */
#include "boot/slot.h"

#include <string.h>

#include "boot/sealed.h"

enum {
    TRAILER_BYTES = 48,
    GENERATION_AT = 0,
    COPY_DONE_AT = 16,
    IMAGE_OK_AT = 24,
    MAGIC_AT = 32,
    MAGIC_BYTES = 16,
    FLAG_SET = 0x01,
};

/* MCUboot's, for alignments up to 8. */
static const uint8_t magic[MAGIC_BYTES] = {
    0x77, 0xc2, 0x95, 0xf3, 0x60, 0xd2, 0xef, 0x7f, 0x35, 0x52, 0x50, 0x0f, 0x2c, 0xb6, 0x79, 0x80,
};

uint32_t slot_address(int slot)
{
    return FLASH_MAP_SLOTS + (uint32_t)slot * FLASH_MAP_SLOT_SIZE;
}

static uint32_t trailer(int slot)
{
    return slot_address(slot) + FLASH_MAP_SLOT_SIZE - TRAILER_BYTES;
}

struct slot slot_read(int slot)
{
    struct slot result = {.state = SLOT_UNSELECTED};
    uint8_t bytes[TRAILER_BYTES];

    if (!flash_read(trailer(slot), bytes, sizeof bytes) || memcmp(bytes + MAGIC_AT, magic, MAGIC_BYTES) != 0)
        return result;
    if (flash_is_erased(bytes + GENERATION_AT, SEALED_BYTES))
        result.generation = 0;
    else if (!sealed_read(bytes + GENERATION_AT, &result.generation))
        return result; /* being erased when the power went */
    if (bytes[IMAGE_OK_AT] == FLAG_SET)
        result.state = SLOT_CONFIRMED;
    else if (bytes[COPY_DONE_AT] == FLAG_SET)
        result.state = SLOT_TRIED;
    else
        result.state = SLOT_PENDING; /* also with a flag half written: it was not started yet */
    return result;
}

/* How well it is to fall back to. */
static unsigned rank(const struct slot *slot)
{
    static const unsigned ranks[] = {[SLOT_UNSELECTED] = 0, [SLOT_TRIED] = 1, [SLOT_PENDING] = 2, [SLOT_CONFIRMED] = 3};

    return ranks[slot->state];
}

int slot_choose(const struct slot slots[SLOT_COUNT], unsigned skip)
{
    int best = SLOT_NONE;

    for (int n = 0; n < SLOT_COUNT; n++) {
        if ((skip >> n & 1u) != 0 || rank(&slots[n]) < rank(&(struct slot){.state = SLOT_PENDING}))
            continue;
        if (best == SLOT_NONE || slots[n].generation > slots[best].generation)
            best = n;
    }
    return best;
}

int slot_keep(const struct slot slots[SLOT_COUNT], unsigned valid)
{
    int best = SLOT_NONE;

    for (int n = 0; n < SLOT_COUNT; n++) {
        if ((valid >> n & 1u) == 0)
            continue;
        if (best == SLOT_NONE || rank(&slots[n]) > rank(&slots[best]) ||
            (rank(&slots[n]) == rank(&slots[best]) && slots[n].generation > slots[best].generation))
            best = n;
    }
    return best;
}

/* Program part of a trailer and see it there. */
static bool put(int slot, uint32_t at, const uint8_t *bytes, size_t size)
{
    uint8_t found[MAGIC_BYTES];

    return flash_program(trailer(slot) + at, bytes, size) && flash_read(trailer(slot) + at, found, size) &&
           memcmp(found, bytes, size) == 0;
}

static bool set_flag(int slot, uint32_t at)
{
    return put(slot, at, &(uint8_t){FLAG_SET}, 1);
}

bool slot_unselect(int slot)
{
    return flash_erase(slot_address(slot) + FLASH_MAP_SLOT_SIZE - FLASH_SECTOR);
}

bool slot_select(int slot, bool permanent)
{
    uint8_t generation[SEALED_BYTES];
    uint32_t last = 0;

    for (int n = 0; n < SLOT_COUNT; n++) {
        const struct slot other = slot_read(n);

        if (other.generation > last)
            last = other.generation;
    }
    sealed_write(generation, last + 1);
    return slot_unselect(slot) && put(slot, GENERATION_AT, generation, sizeof generation) &&
           (!permanent || set_flag(slot, IMAGE_OK_AT)) && put(slot, MAGIC_AT, magic, sizeof magic);
}

bool slot_mark_tried(int slot)
{
    return slot_read(slot).state == SLOT_PENDING && set_flag(slot, COPY_DONE_AT);
}

bool slot_confirm(int slot)
{
    const struct slot now = slot_read(slot);

    return (now.state == SLOT_PENDING || now.state == SLOT_TRIED) && set_flag(slot, IMAGE_OK_AT);
}
