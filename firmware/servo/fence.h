/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * A target that decisions move by steps, one after the other, within a fence. No hardware.
 *
 * The order counts: at the fence a step is lost and the next one the other way is not.
 */
#ifndef SERVO_FENCE_H
#define SERVO_FENCE_H

#include <stdint.h>

/** Places, in counts with 32 fraction bits, within +-2^30 counts, that the target does not pass; the
 * lower one first. */
struct fence {
    int64_t low_q32, high_q32;
};

/** Some decisions, up to 31. */
struct decisions {
    uint32_t bits;  /* the highest 1, and below it the decisions in their order, toward bit 0 */
    unsigned count;
    unsigned longs; /* ones among them */
};

/** Counted. `bits` is not 0. */
struct decisions fence_decisions(uint32_t bits);

/**
 * Walk a target, which is within the fence, by some decisions. Runs in the tick interrupt: about 40
 * clocks, and where the fence may be met 40 for each decision.
 *
 * @param step_q32  Added for a 0, subtracted for a 1; within +-2^29 counts.
 * @return          Bits of the decisions that the fence cut short.
 */
uint32_t fence_walk(const struct fence *fence, int64_t *target_q32, int64_t step_q32,
                    const struct decisions *decisions);

#endif
