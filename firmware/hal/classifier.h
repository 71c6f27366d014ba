/* SPDX-License-Identifier: BSD-2-Clause */
/** Pulses at IN0, judged by their length: decisions, in order, each once. */
#ifndef HAL_CLASSIFIER_H
#define HAL_CLASSIFIER_H

#include <stdbool.h>
#include <stdint.h>

/** The longest filter. */
enum { CLASSIFIER_FILTER_MAX_FAST = 31 };

struct classifier_settings {
    uint32_t threshold_fast; /* length from which on a pulse is long, `fast` clocks, at least 1 */
    uint32_t filter_fast;    /* levels that last as long or less are not seen; 0: off */
    bool at_threshold;       /* a short pulse, too, is judged at the threshold, by the level then */
};

/** Judge pulses that begin from now on; decisions that wait are forgotten. */
void classifier_start(const struct classifier_settings *settings);

/** Other settings while it is at work. */
void classifier_configure(const struct classifier_settings *settings);

/** Judge no more. Decisions that wait, and those of the last microsecond, can still be taken. */
void classifier_stop(void);

/** Batches that wait. */
uint32_t classifier_waiting(void);

/** Decisions for which there was no room, since reset; stays at CLASSIFIER_LOST_MAX. */
enum { CLASSIFIER_LOST_MAX = 0xffff };
uint32_t classifier_lost(void);

/**
 * Take the oldest decisions, up to 8: the highest 1, and below it the decisions in their order, toward
 * bit 0; 1 long, 0 short. 1: there are none. For the tick interrupt.
 */
uint32_t classifier_take(void);

#endif
