/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * A flash chip behind hal/flash.h, in place of the driver: its contents, and what a power cut leaves of them.
 *
 * Bits go from 1 to 0 by programming and to 1 by erasing a sector. A step is one byte programmed, or one of the
 * three moments of an erase: begin, middle, end. The power can be cut before each step:
 *
 *  - in a page, the bytes before the step are there and a random subset of the bits of its own, or a random subset of
 *    the bits of the whole page;
 *  - in an erase, the sector reads unstably until it is erased again: of its bits that were 0 each reads as 1 in a
 *    share of all readings, few at the beginning, nearly all at the end;
 *  - what was not begun is lost.
 */
#ifndef TB_POWERCUT_CHIP_H
#define TB_POWERCUT_CHIP_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/flash.h"

enum { CHIP_SIZE = 16 << 20, CHIP_SECTORS = CHIP_SIZE / FLASH_SECTOR };

/** All of a chip; no pointers, so that it can be copied and shared. All 0 is a chip as delivered. */
struct chip {
    uint8_t zeros[CHIP_SIZE];         /* the contents inverted: memory never touched is erased */
    uint8_t unstable[CHIP_SECTORS];   /* share of readings in 256 that a 0 of the sector is taken for 1 */
    uint32_t erases[CHIP_SECTORS];
    uint64_t steps, bytes_read, reads, pages;
    uint32_t random;

    struct chip_work {
        enum { CHIP_RESTS, CHIP_PROGRAMS, CHIP_ERASES } kind;
        uint32_t address, size, done;  /* of bytes, or of the three moments of an erase */
        uint8_t before[FLASH_PAGE], zeros[FLASH_PAGE];
    } work;
};

/** The chip that is fitted from now on; NULL: none. */
void chip_fit(struct chip *chip);

/** Called before each step, or NULL. */
void chip_on_step(void (*step)(void));

/** Of a chip in a step: its power is cut. `seed` chooses among what that may leave. */
void chip_cut(struct chip *chip, uint32_t seed);

/** Contents at an address, as a perfect reading has them. */
uint8_t chip_byte(const struct chip *chip, uint32_t address);

/** From now on so many more programs and erases are done, the rest fail. Negative: none fails. */
void chip_wear_out(int operations);

#endif
