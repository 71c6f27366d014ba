/* SPDX-License-Identifier: BSD-2-Clause */
/** Switches and TTL inputs, as levels; edges of the TTL inputs; DIP switches. */
#ifndef HAL_INPUTS_H
#define HAL_INPUTS_H

#include <stdbool.h>
#include <stdint.h>

/** All inputs at one instant. In the masks, bit n belongs to axis n; 1: at the limit. */
struct inputs {
    uint32_t limit_lower;
    uint32_t limit_upper;
    bool estop; /* drives are held off */
    bool in0;
    bool in1;
};

void inputs_read(struct inputs *inputs);

enum inputs_ttl { INPUTS_IN0, INPUTS_IN1, INPUTS_TTL_COUNT };

/** What a TTL input has done since it was last asked for. */
struct inputs_edges {
    bool rose, fell;
    bool level;         /* now */
    uint32_t at_cycles; /* of the last edge: the timer's count (hal/timer.h) */
};

/**
 * Take the edges. False: none. However short a pulse was, it is both.
 *
 * @param rose  Called when one of them rose, before they are taken: who looks for them in an
 *              interrupt is told meanwhile; or NULL.
 */
bool inputs_take_edges(enum inputs_ttl pin, struct inputs_edges *edges, void (*rose)(void));

/** IN0 has risen since its edges were last taken; takes nothing. For the tick interrupt. */
bool inputs_in0_has_risen(void);

/** DIP switches: bit n is switch n of the board, 1: on. */
uint32_t inputs_dip(void);

/** Those of an axis, as bits; the emergency stop is everybody's. For the tick interrupt. */
enum { INPUTS_LIMIT_LOWER = 1, INPUTS_LIMIT_UPPER = 2, INPUTS_ESTOP = 4 };
uint32_t inputs_of_axis(unsigned axis);

#endif
