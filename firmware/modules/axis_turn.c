/* SPDX-License-Identifier: BSD-2-Clause */
/* The tick interrupt: what takes turns, one axis a tick. Built for size: it is cold each time. */
#include "modules/axis_state.h"

#include <stddef.h>

#include "hal/inputs.h"
#include "hal/interlock.h"
#include "hal/snapshot.h"

static void release(struct axis *a, enum loop_fault fault)
{
    loop_free(&a->loop, fault);
    a->generation++;
}

static void stop(struct axis *a, enum axis_stop why)
{
    release(a, LOOP_NO_FAULT);
    a->report.stops++;
    a->report.last_stop = why;
    a->report.stop_at_start = why == AXIS_STOP_LIMIT_UPPER ? a->upper_at_start
                                                          : a->lower_at_start;
}

static void note_switches(struct axis *a)
{
    a->lower_at_start = a->limit_lower;
    a->upper_at_start = a->limit_upper;
}

bool axis_begin(struct axis *a)
{
    struct handover *h = &a->handover;

    if (a->loop.mode == LOOP_FREE || a->loop.mode == LOOP_SPIN)
        return false;
    if (h->generation != a->generation) {
        h->state = AXIS_HANDOVER_LATE;
        return false;
    }
    profile_begin(&a->profile, h->plan);
    loop_track(a->config, &a->loop, h->commanded);
    /* Others get it with their turn: of four axes at once it takes 500 clocks. */
    if (h->triggered)
        loop_feed(a->config, &a->loop, &a->profile, !a->limit_lower, !a->limit_upper);
    a->generation++;
    a->begin_tick = axis_ticks();
    note_switches(a);
    h->state = AXIS_HANDOVER_NONE;
    return true;
}

volatile bool axis_trigger_fired, axis_trigger_held;
volatile uint32_t axis_trigger_count;

static bool fits(const struct axis *a)
{
    return a->loop.mode != LOOP_FREE && a->loop.mode != LOOP_SPIN &&
           a->handover.generation == a->generation;
}

void axis_trigger(void)
{
    bool all = true;

    if (!axis_trigger_fired && (axis_trigger_held || !inputs_in0_has_risen()))
        return;
    axis_trigger_fired = false;
    axis_trigger_watched = false;
    for (unsigned i = 0; i < AXIS_COUNT; i++)
        if (axis_states[i].handover.state == AXIS_HANDOVER_ARMED)
            all = all && fits(&axis_states[i]);
    for (unsigned i = 0; i < AXIS_COUNT; i++) {
        struct handover *h = &axis_states[i].handover;

        if (h->state != AXIS_HANDOVER_ARMED)
            continue;
        h->tick = axis_tick_count;
        h->triggered = true;
        h->state = all ? AXIS_HANDOVER_PENDING : AXIS_HANDOVER_LATE;
    }
    if (all)
        axis_trigger_count = axis_trigger_count + 1;
}

void axis_aim(unsigned axis, int64_t target_q32)
{
    struct axis *a = &axis_states[axis];

    if (a->profile.position_q32 == target_q32 || a->profile.plan != NULL ||
        a->loop.mode == LOOP_FREE || a->loop.mode == LOOP_SPIN)
        return;
    a->profile.position_q32 = target_q32;
    loop_jump(a->config, &a->loop, &a->profile, !a->limit_lower, !a->limit_upper);
    a->generation++;
}

static void spin(struct axis *a)
{
    a->spins_seen = a->spins;
    if (a->off)
        return;
    if (a->spin_steps != 0) {
        a->generation++;
        note_switches(a);
        loop_spin(&a->loop, a->spin_steps);
    } else if (a->loop.mode == LOOP_SPIN) {
        release(a, LOOP_NO_FAULT);
    }
}

/* Let go of an axis that must not be driven; take it back when it may and stands still. */
static void supervise(struct axis *a, bool inhibited)
{
    if (a->enables_seen != a->enables) {
        a->enables_seen = a->enables;
        a->fault = false;
    }
    /* Switched off counts also when it is on again already. */
    a->off = inhibited || !a->enabled || a->fault || a->disables_seen != a->disables;
    a->disables_seen = a->disables;
    if (a->loop.mode != LOOP_FREE) {
        if (a->off)
            stop(a, AXIS_STOP_INHIBITED);
    } else if (!a->off && a->loop.still_turns >= AXIS_REST_TURNS) {
        loop_rest(&a->loop);
        a->generation++;
    }
    if (a->spins_seen != a->spins)
        spin(a);
}

/* Neither a set-point nor a spin may lead into a closed switch. */
static void check_limits(struct axis *a)
{
    bool rising, falling;

    if (a->loop.mode == LOOP_FREE)
        return;
    if (a->loop.mode == LOOP_SPIN) {
        rising = a->loop.held_steps > 0;
        falling = a->loop.held_steps < 0;
    } else {
        rising = a->profile.step_q48 > 0;
        falling = a->profile.step_q48 < 0;
    }
    if (rising && a->limit_upper)
        stop(a, AXIS_STOP_LIMIT_UPPER);
    else if (falling && a->limit_lower)
        stop(a, AXIS_STOP_LIMIT_LOWER);
}

static void note_fault(struct axis *a, enum loop_fault fault)
{
    static const uint8_t stops[] = {
        [LOOP_NOT_SETTLED] = AXIS_STOP_NOT_SETTLED,
        [LOOP_DEAD] = AXIS_STOP_DEAD,
        [LOOP_RUNAWAY] = AXIS_STOP_RUNAWAY,
        [LOOP_OVERFLOW] = AXIS_STOP_OVERFLOW,
    };

    a->report.stops++;
    a->report.last_stop = stops[fault];
    a->generation++;
    a->fault = fault != LOOP_NOT_SETTLED;
}

/* Below a count in 20 ms an axis that is told to stay on stands, whatever loads it. */
#define STANDS_Q16 (65536 * AXIS_TICK_US / 20000)

/* The interlock is to know which axes are regulated, and which may stand against a load. */
static void tell_interlock(const struct axis *a, unsigned axis, enum loop_maintain maintain)
{
    static uint32_t armed, hold;
    const int32_t step_q16 = (int32_t)(a->profile.step_q48 >> 32);
    const bool regulated = a->loop.mode > LOOP_SPIN;

    armed &= ~(1u << axis);
    hold &= ~(1u << axis);
    if (regulated)
        armed |= 1u << axis;
    if (regulated && maintain == LOOP_MAINTAIN_HOLD && step_q16 < (int32_t)STANDS_Q16 &&
        -step_q16 < (int32_t)STANDS_Q16)
        hold |= 1u << axis;
    interlock_watch(armed, hold);
}

void axis_turn(struct axis *a, unsigned axis, int32_t position_counts, int32_t duty_steps)
{
    const struct loop_config *config = a->config;
    uint32_t switches = inputs_of_axis(axis);
    bool regulated, commanded, behind;

    a->limit_lower = (switches & INPUTS_LIMIT_LOWER) != 0;
    a->limit_upper = (switches & INPUTS_LIMIT_UPPER) != 0;
    supervise(a, (switches & INPUTS_ESTOP) != 0);
    check_limits(a);

    /* An axis that is let go has its set-point where it is. */
    regulated = a->loop.mode != LOOP_FREE;
    if (a->loop.mode <= LOOP_SPIN)
        profile_rest(&a->profile, (int64_t)position_counts * (INT64_C(1) << 32));

    if (a->configures_seen != a->configures) {
        a->configures_seen = a->configures;
        loop_configure(&a->loop, config);
    }
    commanded = a->loop.commanded;
    behind = a->loop.behind;
    loop_turn(config, &a->loop, &a->profile, position_counts, duty_steps, !a->limit_lower,
              !a->limit_upper);
    if (a->loop.behind && !behind)
        a->report.lags++;
    if (regulated && a->loop.mode == LOOP_FREE) {
        note_fault(a, (enum loop_fault)a->loop.fault);
    } else if (commanded && !a->loop.commanded) {
        a->report.arrivals++;
        a->report.arrival_time_fast = snapshot_tick_time_fast();
    }
    tell_interlock(a, axis, config->maintain);
}
