/* SPDX-License-Identifier: BSD-2-Clause */
/** Random numbers that are the same on every machine: xorshift32 (Marsaglia 2003). */
#ifndef TB_FIRMWARE_RANDOM_H
#define TB_FIRMWARE_RANDOM_H

#include <stdint.h>

static uint32_t random_state = 1; /* never 0 */

/** From 0 to `limit` - 1. */
static inline uint32_t random_below(uint32_t limit)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state % limit;
}

#endif
