/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The flash memory: SPI NOR of 16 MiB, erased by sectors to 1, programmed to 0. Main loop only.
 *
 * Each call waits until the flash is done; false means refused, no flash, or timed out. What is written is not read again
 * to see whether it is there: readers check. What can be changed the gateware decides, see docs/blocks/flash.md.
 */
#ifndef HAL_FLASH_H
#define HAL_FLASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FLASH_PAGE = 256, FLASH_SECTOR = 4096, FLASH_BYTES = 16 << 20 };

/**
 * Look for a flash; the other calls are false until this one was true. Ends what a program before left under way, a frame or
 * an erase of at most a second. Without a flash it takes less than 20 us.
 */
bool flash_present(void);

/** Any size. */
bool flash_read(uint32_t address, void *to, size_t size);

/** Any size, split at pages; at most 10 ms a page. What was done of it when it fails is not known. */
bool flash_program(uint32_t address, const void *from, size_t size);

/** The sector at an address; at most 1 s. */
bool flash_erase(uint32_t address);

/** From now on nothing below FLASH_MAP_GUARDED_END is changed, until power-up. */
void flash_lock(void);

/**
 * What is called again and again while the flash erases or programs; NULL: nothing, as at first. It may do anything but use
 * the flash: every call from there is false.
 */
void flash_on_wait(void (*poll)(void));

#endif
