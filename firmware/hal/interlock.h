/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The interlock: takes drives off by itself and says why. The firmware gives it limits, says where axes
 * are to be, and clears faults; it cannot keep one from being found.
 */
#ifndef HAL_INTERLOCK_H
#define HAL_INTERLOCK_H

#include <stdbool.h>
#include <stdint.h>

enum { INTERLOCK_AXES = 4 };

/** Faults of an axis, which is held off by each of them until it is cleared; bits of a mask. */
enum interlock_fault {
    INTERLOCK_ILLEGAL = 1,     /* its encoder makes illegal transitions */
    INTERLOCK_NO_PROGRESS = 2, /* driven, and its count makes no way */
    INTERLOCK_OVER_SPEED = 4,
    INTERLOCK_FOLLOWING = 8,   /* too far from where it was to be */
};

struct interlock_limits {
    uint32_t strong_time_half_us; /* INTERLOCK_STRONG_STEPS have made way by then; up to 65535 */
    uint32_t breakaway_steps;     /* drive that moves it, 1 to 4095 */
    uint32_t speed_counts;        /* in 100 us, up to 65535 */
    uint32_t following_counts;    /* up to 2^31 - 1 */
};

/** Half of full drive: strong. Way is made with so many counts. */
enum { INTERLOCK_STRONG_STEPS = 1250, INTERLOCK_WAY_COUNTS = 2 };

void interlock_limit(unsigned axis, const struct interlock_limits *limits);

/** Faults of all axes, as one word; 0: none. */
uint32_t interlock_faults(void);

/** The same, as far as their causes are there now. */
uint32_t interlock_causes(void);

/** Of such a word, the faults of an axis. */
uint32_t interlock_of_axis(uint32_t faults, unsigned axis);

/** Clear the faults of an axis. False: some cause is not gone, and its fault stays. */
bool interlock_clear(unsigned axis);

/**
 * The processor was reset, which holds all axes off; from this call on it no longer does. To be called
 * when duties are 0.
 */
bool interlock_take_reset(void);

/** Axes (bit masks) that are to follow what is expected, and axes that may stand at any drive. */
void interlock_watch(uint32_t armed, uint32_t hold);

/** Where axes are to be. In the tick interrupt. */
void interlock_expect(const int32_t position_counts[INTERLOCK_AXES]);

#endif
