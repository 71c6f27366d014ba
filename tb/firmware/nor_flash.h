/* SPDX-License-Identifier: BSD-2-Clause */
/** hal/flash.h over an array: what a flash does to its bits, without its registers and its time. */
#ifndef TB_FIRMWARE_NOR_FLASH_H
#define TB_FIRMWARE_NOR_FLASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NOR_FLASH_BYTES = 0x600000 };

/** The contents, to look at and to change. */
extern uint8_t nor_flash[NOR_FLASH_BYTES];

/** Erased, unlocked, with power. */
void nor_flash_reset(void);

/**
 * Cut the power in the change (a byte programmed, a sector erased) after so many, which is done in part: some of the bits.
 * Nothing changes any more, and every call fails, until nor_flash_power_up.
 */
void nor_flash_cut_after(unsigned long changes);
void nor_flash_power_up(void);

/** Changes since nor_flash_reset or nor_flash_cut_after. */
unsigned long nor_flash_changes(void);

#endif
