/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/fence.h"

unsigned fence_count(uint32_t decisions)
{
    unsigned count = 0;

    while (decisions >>= 1)
        count++;
    return count;
}

uint32_t fence_walk(const struct fence *fence, int64_t *target_q32, int64_t step_q32,
                    uint32_t decisions)
{
    const int64_t low = fence->low_q32, high = fence->high_q32;
    int64_t target = *target_q32;
    uint32_t clipped = 0;

    for (uint32_t bit = UINT32_C(1) << fence_count(decisions) >> 1; bit != 0; bit >>= 1) {
        target += (decisions & bit) != 0 ? -step_q32 : step_q32;
        if (target > high) {
            target = high;
            clipped |= bit;
        } else if (target < low) {
            target = low;
            clipped |= bit;
        }
    }
    *target_q32 = target;
    return clipped;
}
