/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Set-point profile: segments of constant jerk (0 in a trapezoid), sampled at servo ticks.
 *
 * A plan is made once, in floating point, outside the interrupt. It describes a motion in
 * continuous time; each segment carries the exact state of its first tick, so the boundary between
 * two segments may lie anywhere between two ticks and rounding does not pass from one segment to
 * the next. The interrupt then only adds forward differences,
 *
 *     position += step;   step += change;   change += jerk;
 *
 * which is exact for constant jerk: step is the way to the next tick, change how much longer the
 * way after it is. Positions are counts in 32.32 fixed point (`_q32`, range +-2^31 counts); steps,
 * velocities (counts per tick, below 2^15), changes and jerks have 48 fraction bits. The smallest
 * speed is 2^-32 counts per tick: 1e-10 mm/s at 45396 counts/mm and 20 kHz. What rounding adds
 * within a segment stays below 1e-3 counts up to ramps of 2^20 ticks.
 *
 * No hardware, no clock: a tick is whatever the caller says it is.
 */
#ifndef SERVO_PROFILE_H
#define SERVO_PROFILE_H

#include <stdbool.h>
#include <stdint.h>

/** Segments of the longest plan: two changes of speed of three segments each, and a cruise. */
#define PROFILE_SEGMENTS_MAX 7u

/** A set-point at one tick. */
struct profile_point {
    int64_t position_q32; /**< Counts. */
    int64_t velocity_q48; /**< Counts per tick. */
};

/** A run of ticks under one jerk. */
struct profile_segment {
    uint64_t ticks;       /**< How many ticks it lasts, at least 1. */
    int64_t position_q32; /**< Set-point at its first tick. */
    int64_t step_q48;     /**< From its first tick to the next. */
    int64_t change_q48;   /**< By how much the second step is longer. */
    int64_t jerk_q48;     /**< By how much the change grows each tick. */
};

/** A motion that ends at rest. Written by the planner, read-only afterwards. */
struct profile_plan {
    uint32_t segment_count;
    struct profile_segment segment[PROFILE_SEGMENTS_MAX];
    int64_t end_q32; /**< Where it comes to rest, after the last segment. */
};

/** What a motion must keep to; the speed and acceleration above 0, in counts and ticks. */
struct profile_bounds {
    double speed;        /**< Largest cruise speed. */
    double acceleration; /**< Acceleration and deceleration, mean over a change of speed. */
    double jerk_ticks;   /**< Time the acceleration takes to come and to go; 0: trapezoid. */
};

/** All the interrupt remembers. What every tick touches comes first: one line of the cache. */
struct profile_state {
    int64_t position_q32; /**< The set-point of the present tick. */
    int64_t step_q48;     /**< Way to the next one; 0 at rest. */
    int64_t change_q48;
    uint32_t ticks_left;             /**< Of the segment, this tick included; the lower 32 bits. */
    const struct profile_plan *plan; /**< Null when at rest. */

    int64_t jerk_q48;
    uint32_t ticks_left_high; /**< The 2^32s of ticks that are left beyond ticks_left. */
    uint32_t index;           /**< Segment in progress. */
};

/**
 * Plan the fastest motion from `start` to rest at `target_q32`, within bounds.
 *
 * Starts from any velocity, also one that is too fast or leads away from the target: then it brakes
 * first, overshoots where it must, and returns. An acceleration at the start is not known here and
 * ends at once. The whole way must lie within 2^31 counts of the start. A segment shorter than the
 * distance to the next tick is left out (its effect is in the next segment's first set-point). Main
 * loop only: uses floating point.
 *
 * @param start       Set-point at the plan's tick 0.
 * @param target_q32  Where to stop.
 */
void profile_plan_move(struct profile_plan *plan, const struct profile_point *start,
                       int64_t target_q32, const struct profile_bounds *bounds);

/**
 * The first whole count at which a motion can be at rest within bounds, in the direction of motion.
 *
 * @return Position in counts, 32.32; the nearest whole count when `start` is at rest.
 */
int64_t profile_stop_q32(const struct profile_point *start, const struct profile_bounds *bounds);

/** Ticks the plan lasts: from its tick 0 to the first tick at rest. */
uint64_t profile_ticks(const struct profile_plan *plan);

/** The set-point `ticks` after the plan's tick 0: what `profile_tick` arrives at, but for rounding
 * (1e-3 counts). */
struct profile_point profile_at(const struct profile_plan *plan, uint64_t ticks);

/** The set-point of the present tick. */
struct profile_point profile_now(const struct profile_state *st);

/** Put the set-point at rest at a position. */
void profile_rest(struct profile_state *st, int64_t position_q32);

/** Begin a plan: the present tick is its tick 0. Runs in the tick interrupt. */
void profile_begin(struct profile_state *st, const struct profile_plan *plan);

/** For profile_tick: the segment's lower 32 bits of ticks have run out. */
void profile_turn(struct profile_state *st);

/** Whether a plan is in progress: false from the first tick at rest on. */
static inline bool profile_moving(const struct profile_state *st)
{
    return st->plan != 0;
}

/**
 * One tick on. Runs in the tick interrupt: three additions, or the load of the next segment. At
 * rest it does nothing.
 *
 * @return  True: a segment was loaded, or the plan has ended, which took some time.
 */
static inline bool profile_tick(struct profile_state *st)
{
    if (!st->plan)
        return false;
    if (__builtin_expect(--st->ticks_left == 0, 0)) {
        profile_turn(st);
        return true;
    }
    st->position_q32 += st->step_q48 >> 16;
    st->step_q48 += st->change_q48;
    st->change_q48 += st->jerk_q48;
    return false;
}

#endif
