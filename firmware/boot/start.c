/* SPDX-License-Identifier: BSD-2-Clause */
#include "boot/start.h"

#include "boot/counter.h"

int start_load(uint8_t *memory, struct image *image)
{
    const uint32_t counter_least = counter_read();
    struct slot slots[SLOT_COUNT];
    unsigned refused = 0;
    int slot;

    for (int n = 0; n < SLOT_COUNT; n++)
        slots[n] = slot_read(n);
    while ((slot = slot_choose(slots, refused)) != SLOT_NONE) {
        if (image_load(slot_address(slot), SLOT_IMAGE_BYTES, counter_least, memory, image) == IMAGE_VALID) {
            if (slots[slot].state == SLOT_CONFIRMED) {
                counter_raise(image_counter(&image->version));
                return slot;
            }
            /* Without the note it could be started, and fail, for ever. */
            if (slot_mark_tried(slot))
                return slot;
        }
        refused |= 1u << slot;
    }
    return SLOT_NONE;
}
