/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Back end of the settings: a file in the flash (hal/flash_map.h), by littlefs.
 *
 * The values live in RAM (settings_ram); the file is their image, written whole at each commit beside
 * the one before, which littlefs then lets go of in one step: whenever the power goes, the file is the
 * one or the other. A commit erases a sector or two and so takes 50 to 800 ms; what flash_on_wait calls
 * goes on meanwhile, and may change values, but must not commit.
 *
 * The file, little-endian: "ABSE", 16 bits version, 16 bits number of values; for each 32 bits key and
 * 64 bits IEEE 754 value; CRC-32 of all before, as littlefs checks its own data but not that of files.
 */
#ifndef STORE_SETTINGS_FLASH_H
#define STORE_SETTINGS_FLASH_H

#include "core/settings.h"

/**
 * Read what is kept. Power-up, once. A flash that is blank there holds nothing; it is formatted when
 * something is first kept. One that cannot be read holds nothing either, is `damaged`, and is formatted then too.
 */
const struct settings_store *settings_flash(void);

#endif
