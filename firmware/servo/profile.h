/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Set-point profile: constant-acceleration segments, sampled at servo ticks.
 *
 * A plan is made once, in floating point, outside the interrupt. It describes a motion in
 * continuous time; each segment carries the exact position and velocity of its first tick, so the
 * boundary between two segments may lie anywhere between two ticks and rounding does not pass from
 * one segment to the next. The interrupt then only adds:
 *
 *     position += velocity + a/2;   velocity += a;
 *
 * which is exact for constant acceleration. Positions are counts in 32.32 fixed point (`_q32`,
 * range +-2^31 counts), velocities counts per tick, accelerations counts per tick^2, with the same
 * 32 fraction bits. The smallest speed step is therefore 2^-32 counts per tick: 2.6e-11 mm/s at
 * 45396 counts/mm and 5 kHz.
 *
 * No hardware, no clock: a tick is whatever the caller says it is.
 */
#ifndef SERVO_PROFILE_H
#define SERVO_PROFILE_H

#include <stdbool.h>
#include <stdint.h>

/** Segments of the longest plan: change of speed, cruise, brake. */
#define PROFILE_SEGMENTS_MAX 3u

/** A set-point at one tick. */
struct profile_point {
    int64_t position_q32; /**< Counts. */
    int64_t velocity_q32; /**< Counts per tick. */
};

/** A run of ticks under one acceleration. */
struct profile_segment {
    uint64_t ticks;                /**< How many ticks it lasts, at least 1. */
    struct profile_point first;    /**< Set-point at its first tick. */
    int64_t half_acceleration_q32; /**< Half the acceleration, counts per tick^2. */
};

/** A motion that ends at rest. Written by the planner, read-only afterwards. */
struct profile_plan {
    uint32_t segment_count;
    struct profile_segment segment[PROFILE_SEGMENTS_MAX];
    int64_t end_q32; /**< Where it comes to rest, after the last segment. */
};

/** All the interrupt remembers. */
struct profile_state {
    const struct profile_plan *plan; /**< Null when at rest. */
    uint32_t index;                  /**< Segment in progress. */
    uint64_t ticks_left;             /**< Of that segment, this tick included. */
    struct profile_point now;        /**< The set-point of the present tick. */
    int64_t half_acceleration_q32;   /**< Of the present tick; 0 at rest. */
};

/**
 * Plan the fastest motion from `start` to rest at `target_q32`, within a speed and an acceleration.
 *
 * Starts from any velocity, also one that is too fast or leads away from the target: then it brakes
 * first, overshoots where it must, and returns. The whole way must lie within 2^31 counts of the
 * start. A segment shorter than the distance to the next tick is left out (its effect is in the
 * next segment's first set-point). Main loop only: uses floating point.
 *
 * @param start                  Set-point at the plan's tick 0.
 * @param target_q32             Where to stop.
 * @param speed_per_tick         Largest cruise speed, counts per tick, above 0.
 * @param acceleration_per_tick2 Acceleration and deceleration, counts per tick^2, above 0.
 */
void profile_plan_move(struct profile_plan *plan, const struct profile_point *start,
                       int64_t target_q32, double speed_per_tick,
                       double acceleration_per_tick2);

/**
 * The first whole count at which a motion can be at rest without exceeding an acceleration, in the
 * direction of motion.
 *
 * @return Position in counts, 32.32; the nearest whole count when `start` is at rest.
 */
int64_t profile_stop_q32(const struct profile_point *start, double acceleration_per_tick2);

/** Ticks the plan lasts: from its tick 0 to the first tick at rest. */
uint64_t profile_ticks(const struct profile_plan *plan);

/** The set-point `ticks` after the plan's tick 0: bit for bit what `profile_tick` arrives at. */
struct profile_point profile_at(const struct profile_plan *plan, uint64_t ticks);

/** Put the set-point at rest at a position. */
void profile_rest(struct profile_state *st, int64_t position_q32);

/** Begin a plan: the present tick is its tick 0. Runs in the tick interrupt. */
void profile_begin(struct profile_state *st, const struct profile_plan *plan);

/**
 * One tick on. Runs in the tick interrupt: a few additions, or the load of the next segment. At
 * rest it does nothing.
 */
void profile_tick(struct profile_state *st);

/** Whether a plan is in progress: false from the first tick at rest on. */
static inline bool profile_moving(const struct profile_state *st)
{
    return st->plan != 0;
}

#endif
