/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * A number in flash that is either whole or known not to be: the number and its complement, 8 bytes, lowest first.
 *
 * Programming only clears bits and erasing only sets them, so what a power cut leaves of either has both bits set or
 * both clear in some place, unless nothing or everything was done.
 */
#ifndef BOOT_SEALED_H
#define BOOT_SEALED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SEALED_BYTES = 8 };

static inline uint32_t sealed_word(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static inline void sealed_write(uint8_t to[SEALED_BYTES], uint32_t value)
{
    for (unsigned n = 0; n < 4; n++) {
        to[n] = (uint8_t)(value >> 8 * n);
        to[4 + n] = (uint8_t)(~value >> 8 * n);
    }
}

/** False: not whole. */
static inline bool sealed_read(const uint8_t from[SEALED_BYTES], uint32_t *value)
{
    *value = sealed_word(from);
    return sealed_word(from + 4) == ~*value;
}

/** Nothing was ever programmed into these bytes. */
static inline bool flash_is_erased(const uint8_t *bytes, size_t size)
{
    for (size_t n = 0; n < size; n++)
        if (bytes[n] != 0xff)
            return false;
    return true;
}

#endif
