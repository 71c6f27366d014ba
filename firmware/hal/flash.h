/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The flash memory: SPI NOR, erased by sectors to 1, programmed to 0. Each call waits until the flash is
 * done; false means refused, no flash, or timed out.
 */
#ifndef HAL_FLASH_H
#define HAL_FLASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FLASH_PAGE = 256, FLASH_SECTOR = 4096 };

bool flash_present(void);
bool flash_read(uint32_t address, void *to, size_t size);
bool flash_program(uint32_t address, const void *from, size_t size);
bool flash_erase(uint32_t address);
void flash_guard(uint32_t lowest);
void flash_on_wait(void (*poll)(void));

#endif
