/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The flash of the board model (tb/board/nor.h) behind hal/flash.h, without its commands and its time: one in a process, its
 * contents an array.
 */
#ifndef TB_FIRMWARE_NOR_FLASH_H
#define TB_FIRMWARE_NOR_FLASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NOR_FLASH_BYTES = 0x600000 }; /* that are used, of 16 MiB */

/** The contents, to look at and to change. */
extern uint8_t nor_flash[NOR_FLASH_BYTES];

/** Erased, unlocked, with power. */
void nor_flash_reset(void);

/** As nor_flash_reset, but with these contents. */
void nor_flash_put(const uint8_t *contents);

/**
 * Cut the power in the change (a byte programmed, a sector erased) after so many, which is done in part.
 * Nothing changes any more, and every call fails, until nor_flash_power_up.
 */
void nor_flash_cut_after(unsigned long changes);
void nor_flash_power_up(void);

/** Changes since nor_flash_reset or nor_flash_cut_after. */
unsigned long nor_flash_changes(void);

#endif
