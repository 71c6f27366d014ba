/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/motion_state.h"

#include <math.h>
#include <stddef.h>

#include "core/events.h"
#include "modules/interlock.h"
#include "modules/limits.h"
#include "modules/tuning.h"

/* Ticks between planning and the start of a plan, for each axis planned, when some of them move:
 * 2.5 ms; a plan takes up to 2 ms of the target's processor. When it was late all the same, the next
 * one gets twice the time. */
#define LEAD_TICKS (2500u / AXIS_TICK_US)
#define LEAD_TICKS_LATE (2u * LEAD_TICKS)

struct motion motions[AXIS_COUNT];
static bool busy_before;

void motion_tell(unsigned axis, enum motion_end why)
{
    const struct motion *m = &motions[axis];

    if (m->claimed && m->owner->ended != NULL)
        m->owner->ended(axis, why);
}

bool motion_may_take(unsigned axis, const struct motion_owner *owner)
{
    const struct motion *m = &motions[axis];

    return !m->claimed || m->owner == owner || m->owner->yield == NULL ||
           m->owner->yield(axis, owner);
}

void motion_take(unsigned axis, const struct motion_owner *owner)
{
    struct motion *m = &motions[axis];

    if (m->owner != owner)
        motion_tell(axis, MOTION_TAKEN);
    m->owner = owner;
    m->claimed = true;
}

bool motion_claim(unsigned axes, const struct motion_owner *owner)
{
    motion_withdraw_prepared();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0 && !motion_may_take(axis, owner))
            return false;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0)
            motion_take(axis, owner);
    return true;
}

void motion_release(unsigned axes, const struct motion_owner *owner)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0 && motions[axis].owner == owner)
            motions[axis].claimed = false;
}

const struct motion_owner *motion_owner(unsigned axis)
{
    return motions[axis].owner;
}

/* Bounds for a change of speed in at most `ramp_ms` from what the axis now has. */
static struct profile_bounds bounds_of(const struct motion_move *move,
                                       const struct profile_point *start, double ramp_ms)
{
    double speed_per_tick = move->speed_counts_per_s * (AXIS_TICK_US * 1e-6);

    return (struct profile_bounds){
        .speed = speed_per_tick,
        /* SPEED or the scale may have become less under way: it takes no longer to brake. */
        .acceleration = fmax(speed_per_tick / tuning_ticks(move->ramp_ms),
                             fabs((double)start->velocity_q48) / 0x1p48 / tuning_ticks(ramp_ms)),
    };
}

uint32_t motion_plan(unsigned axis, const struct motion_move *move, uint64_t tick)
{
    const struct motion *m = &motions[axis];
    unsigned leg = move == &m->move ? m->leg : 0;
    int32_t target_counts =
        leg < move->via_count ? move->via_counts[leg] : move->target_counts;
    struct profile_plan *made = axis_plan(axis);
    uint32_t generation;
    struct profile_point start = axis_predict(axis, tick, &generation);
    struct profile_bounds bounds = bounds_of(move, &start, tuning_ramp_ms(axis));

    bounds.jerk_ticks = tuning_jerk_ticks(axis);
    profile_plan_move(made, &start, (int64_t)target_counts * (INT64_C(1) << 32), &bounds);
    return generation;
}

static uint32_t plan_stop(unsigned axis, uint64_t tick)
{
    struct motion *m = &motions[axis];
    struct profile_plan *made = axis_plan(axis);
    uint32_t generation;
    struct profile_point start = axis_predict(axis, tick, &generation);
    struct profile_bounds bounds = bounds_of(&m->move, &start, TUNING_BRAKE_MS);
    int64_t target_q32 = profile_stop_q32(&start, &bounds);

    m->end_counts = (int32_t)(target_q32 >> 32);
    profile_plan_move(made, &start, target_q32, &bounds);
    return generation;
}

/* Write the plan of an axis for a start at `tick`; returns the generation it holds for. */
static uint32_t plan(unsigned axis, uint64_t tick)
{
    return motions[axis].stopping ? plan_stop(axis, tick)
                                  : motion_plan(axis, &motions[axis].move, tick);
}

static bool any_moves(unsigned axes)
{
    struct axis_view view;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if ((axes & MOTION_AXIS(axis)) == 0)
            continue;
        axis_read(axis, &view);
        if (view.planned)
            return true;
    }
    return false;
}

/* Make the plans of some axes and hand them over, all to begin at one tick: if they all rest, as soon
 * as the plans are made; else at one for which it can be said where they will be. */
static void launch(unsigned axes, unsigned lead_ticks)
{
    uint32_t generations[AXIS_COUNT];
    uint64_t tick;
    bool moving;

    if (axes == 0)
        return;
    moving = any_moves(axes);
    tick = axis_ticks() + 1;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0 && moving)
            tick += lead_ticks;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0)
            generations[axis] = plan(axis, tick);
    if (!moving)
        tick = axis_ticks() + 2;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0)
            axis_hand_over(axis, generations[axis], tick,
                           !motions[axis].stopping && !motion_is_under_way(&motions[axis]));
}

/* Plan the moves that wait. */
static void start_waiting(unsigned axes)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0) {
            motions[axis].waiting = false;
            motions[axis].stopping = false;
        }
    launch(axes, LEAD_TICKS);
}

/* A plan waits for its tick. An axis that is not regulated begins none: nothing is put off. */
static bool is_about_to_begin(unsigned axis)
{
    struct axis_view view;

    if (axis_handover(axis) != AXIS_HANDOVER_PENDING)
        return false;
    axis_read(axis, &view);
    return view.mode != LOOP_FREE;
}

void motion_start(const struct motion_move *moves, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        struct motion *m = &motions[moves[i].axis];
        int32_t from_counts;

        if (!axis_enabled(moves[i].axis))
            continue;
        from_counts = motion_place_counts(moves[i].axis);
        m->move = moves[i];
        m->move.target_counts = limits_clip(moves[i].axis, from_counts, moves[i].target_counts);
        for (unsigned n = 0; n < m->move.via_count; n++)
            m->move.via_counts[n] =
                limits_nearest(moves[i].axis, from_counts, m->move.via_counts[n]);
        m->leg = 0;
        m->end_counts = m->move.target_counts;
        m->waiting = true;
    }
}

void motion_stop(unsigned axes)
{
    motion_withdraw_prepared();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        struct motion *m = &motions[axis];
        struct axis_view view;

        if ((axes & MOTION_AXIS(axis)) == 0)
            continue;
        m->waiting = false;
        motion_forget_legs(m);
        /* A stop under way is left alone: stops that follow each other would put it off. */
        if (m->stopping && axis_handover(axis) != AXIS_HANDOVER_NONE)
            continue;
        (void)axis_plan(axis); /* withdraws one that has not begun */
        axis_read(axis, &view);
        if ((m->stopping && view.planned) || (!view.planned && !view.commanded))
            continue;
        m->stopping = true;
        m->move.speed_counts_per_s = tuning_counts_per_s(axis, tuning_speed_max_mm_per_s(axis));
        m->move.ramp_ms = TUNING_BRAKE_MS;
        launch(MOTION_AXIS(axis), LEAD_TICKS); /* none waits for the others */
    }
}

bool motion_halt(void)
{
    bool commanded = false;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        commanded |= motion_axis_busy(axis) && !motions[axis].owner->open_loop;
    motion_stop(MOTION_AXES_ALL);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        motion_tell(axis, MOTION_HALTED);
    events_publish(EVENT_HALT, commanded, events_now());
    return commanded;
}

static void switch_off(unsigned axis, enum motion_end why)
{
    motion_withdraw_prepared();
    axis_enable(axis, false);
    motions[axis].waiting = false;
    motion_forget_legs(&motions[axis]);
    (void)axis_plan(axis);
    motion_tell(axis, why);
}

void motion_enable(unsigned axis, bool enable)
{
    if (!enable) {
        switch_off(axis, MOTION_DISABLED);
        return;
    }
    motion_withdraw_prepared();
    interlock_release(axis);
    axis_enable(axis, true);
}

void motion_fail(unsigned axis)
{
    switch_off(axis, MOTION_FAULT);
}

bool motion_enabled(unsigned axis)
{
    return axis_enabled(axis);
}

bool motion_ready(unsigned axis)
{
    return axis_enabled(axis) && !axis_inhibited();
}

bool motion_axis_moves(unsigned axis)
{
    const struct motion *m = &motions[axis];

    motion_notice_prepared();
    if (m->owner == NULL || !m->owner->busy)
        return false;
    if (m->waiting)
        return true;
    if (m->stopping)
        return false;
    if (motion_is_under_way(m) || motion_handed_over(axis))
        return true;
    return axis_commanded(axis);
}

bool motion_axis_busy(unsigned axis)
{
    const struct motion *m = &motions[axis];

    if (motion_axis_moves(axis))
        return true;
    return m->owner != NULL && m->owner->busy && m->claimed && m->owner->holds;
}

bool motion_busy(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (motion_axis_busy(axis))
            return true;
    return false;
}

/* A plan is in the making, or made and not begun. */
static bool is_planning(unsigned axis)
{
    motion_notice_prepared();
    return motions[axis].waiting || motion_is_under_way(&motions[axis]) || motion_handed_over(axis);
}

bool motion_stands(unsigned axis)
{
    struct axis_view view;

    if (is_planning(axis))
        return false;
    axis_read(axis, &view);
    return !view.planned && view.mode != LOOP_FREE && view.mode != LOOP_SPIN;
}

bool motion_in_position(unsigned axis)
{
    struct axis_view view;

    if (is_planning(axis))
        return false;
    axis_read(axis, &view);
    return (view.mode == LOOP_IDLE || view.mode == LOOP_HOLD) && !view.commanded;
}

int32_t motion_position_counts(unsigned axis)
{
    return axis_position_counts(axis);
}

int32_t motion_place_counts(unsigned axis)
{
    return motion_in_position(axis) ? motion_target_counts(axis) : motion_position_counts(axis);
}

int32_t motion_target_counts(unsigned axis)
{
    struct axis_view view;

    if (is_planning(axis))
        return motions[axis].end_counts;
    axis_read(axis, &view);
    return (int32_t)(view.end_q32 >> 32);
}

double motion_speed_max_mm_per_s(unsigned axis)
{
    return tuning_speed_max_mm_per_s(axis);
}

static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        motions[axis] = (struct motion){0};
    busy_before = false;
    motion_prepared_init();
}

static void poll(void)
{
    unsigned late = 0, waiting = 0;
    bool wait = false, busy;

    motion_notice_prepared();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        motion_report(axis);
        if (motions[axis].waiting) {
            waiting |= MOTION_AXIS(axis);
            wait |= is_about_to_begin(axis);
        } else if (axis_handover(axis) == AXIS_HANDOVER_LATE) {
            late |= MOTION_AXIS(axis);
        }
    }
    launch(late, LEAD_TICKS_LATE);
    if (!wait)
        start_waiting(waiting);
    busy = motion_busy();
    if (busy != busy_before) {
        busy_before = busy;
        events_publish(EVENT_BUSY, busy, events_now());
    }
}

const struct module motion_module = {
    .name = "motion",
    .init = init,
    .poll = poll,
};
