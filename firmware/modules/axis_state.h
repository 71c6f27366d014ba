/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The state of the axes: what modules/axis.c, axis_tick.c and axis_turn.c share, and nobody else.
 *
 * Who writes what is said at each field; the contract is modules/axis.h's.
 */
#ifndef MODULES_AXIS_STATE_H
#define MODULES_AXIS_STATE_H

#include "modules/axis.h"

/* A plan for the interrupt to begin. Written by the main loop while `state` is not PENDING; the
 * interrupt only moves `state` on from there. */
struct handover {
    volatile enum axis_handover state;
    uint32_t tick;
    uint32_t generation;
    const struct profile_plan *plan;
    bool commanded;
    bool triggered; /* it drives from its first tick on */
};

/* What every tick touches stands together and comes first: the data cache is small. */
struct axis {
    struct profile_state profile;
    struct loop_state loop;
    struct handover handover;

    /* The main loop's. */
    const struct loop_config *volatile config;
    volatile uint32_t configures; /* times it was given another */
    volatile bool enabled;
    volatile uint32_t enables, disables; /* times it was switched on and off */
    volatile uint32_t spins;             /* times spin_steps was set */
    volatile int32_t spin_steps;

    /* The interrupt's. */
    uint32_t configures_seen, enables_seen, disables_seen, spins_seen;
    uint32_t generation;
    bool off; /* must not or cannot be driven */
    bool fault;
    bool limit_lower, limit_upper;
    bool lower_at_start, upper_at_start; /* closed when the motion began */
    uint64_t begin_tick; /* of the plan in progress */
    struct axis_report report;
} __attribute__((aligned(32)));

extern struct axis axis_states[AXIS_COUNT];

/* Written by the interrupt. The main loop reads `ticks` before and after what is of one tick. */
extern volatile uint32_t axis_tick_count, axis_tick_count_high;
extern volatile uint32_t axis_cycles_last, axis_cycles_max;

/* Whether ticks look for the trigger; the main loop's, and cleared by the tick that finds it. */
extern volatile bool axis_trigger_watched, axis_trigger_fired, axis_trigger_held;
extern volatile uint32_t axis_trigger_count; /* the interrupt's */

extern void (*volatile axis_source)(void); /* the main loop's */

/* In the tick interrupt: when the trigger has come, let all that is armed begin in this tick. */
void axis_trigger(void);

/* In the tick interrupt: begin the plan that is handed over, if it fits; whether it did. */
bool axis_begin(struct axis *a);

/* In the tick interrupt: what takes turns. `duty_steps` is that of this tick. */
void axis_turn(struct axis *a, unsigned axis, int32_t position_counts, int32_t duty_steps);

#endif
