/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/fence.h"

#include <stdbool.h>

/* Steps below this add up in 64 bits: 2^26 counts. */
#define SUM_FITS (INT64_C(1) << 58)

struct decisions fence_decisions(uint32_t bits)
{
    struct decisions decisions = {.bits = bits};

    for (; bits > 1; bits >>= 1) {
        decisions.count++;
        decisions.longs += bits & 1;
    }
    return decisions;
}

/* Whatever their order, these steps end within the fence all the way. */
static bool is_far(const struct fence *fence, int64_t target, int64_t step, unsigned count)
{
    const int64_t reach = step < SUM_FITS ? step * (int64_t)count : INT64_MAX;

    return fence->high_q32 - target >= reach && target - fence->low_q32 >= reach;
}

uint32_t fence_walk(const struct fence *fence, int64_t *target_q32, int64_t step_q32,
                    const struct decisions *decisions)
{
    const int64_t low = fence->low_q32, high = fence->high_q32;
    const bool falls = step_q32 < 0; /* at a 0 */
    const int64_t step = falls ? -step_q32 : step_q32;
    const uint32_t down = falls ? ~decisions->bits : decisions->bits;
    int64_t target = *target_q32;
    uint32_t clipped = 0;

    if (is_far(fence, target, step, decisions->count)) {
        *target_q32 = target + step_q32 * ((int64_t)decisions->count - 2 * (int64_t)decisions->longs);
        return 0;
    }
    for (uint32_t bit = UINT32_C(1) << decisions->count >> 1; bit != 0; bit >>= 1) {
        if ((down & bit) != 0) {
            target -= step;
            if (target >= low)
                continue;
            target = low;
        } else {
            target += step;
            if (target <= high)
                continue;
            target = high;
        }
        clipped |= bit;
    }
    *target_q32 = target;
    return clipped;
}
