/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The flash of the board model (tb/board/nor.h) behind hal/flash.h, in place of the driver, without its commands and its time.
 *
 * The power can be cut before each step of a change.
 */
#ifndef TB_POWERCUT_CHIP_H
#define TB_POWERCUT_CHIP_H

#include <stdbool.h>
#include <stdint.h>

#include "../board/nor.h"
#include "hal/flash.h"

/** All of a chip, and what has been done to it; can be copied and shared, and is where it was fitted or cut last. */
struct chip {
    uint8_t bytes[NOR_BYTES];
    struct nor nor;
    uint32_t erases[NOR_SECTORS];
    uint64_t steps, bytes_read, reads, pages;
};

/** As delivered: all of it is erased, of which only a part has to be written into memory. */
void chip_deliver(struct chip *chip, uint32_t first, uint32_t size);

/** The chip that is fitted from now on; NULL: none. */
void chip_fit(struct chip *chip);

/** Called before each step, or NULL. */
void chip_on_step(void (*step)(void));

/** Of a chip in a step: its power is cut. `seed` chooses among what that may leave. */
void chip_cut(struct chip *chip, uint32_t seed);

/** From now on so many more programs and erases are done, the rest fail. Negative: none fails. */
void chip_wear_out(int operations);

#endif
