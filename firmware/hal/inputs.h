/* SPDX-License-Identifier: BSD-2-Clause */
/** Switches and TTL inputs, as levels. */
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

#endif
