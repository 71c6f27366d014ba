/* SPDX-License-Identifier: BSD-2-Clause */
/* Moves that are planned before their trigger comes, so that the tick that sees it can begin them. */
#include "modules/motion_state.h"

#include <stddef.h>

#include "modules/limits.h"
#include "modules/tuning.h"

static struct {
    enum {
        NOTHING,
        ARMED, /* the interrupt looks for the trigger */
        FIRED, /* the trigger has been given here, and not yet taken notice of */
    } state;
    bool begun; /* what was prepared last has begun, and nobody has asked */
    const struct motion_owner *owner;
    unsigned count;
    struct motion_move moves[AXIS_COUNT];
    double jerk_ticks[AXIS_COUNT]; /* planned with */
    uint32_t generations[AXIS_COUNT], triggers;
} prepared;

void motion_prepared_init(void)
{
    prepared.state = NOTHING;
    prepared.begun = false;
}

bool motion_handed_over(unsigned axis)
{
    const enum axis_handover handover = axis_handover(axis);

    return handover != AXIS_HANDOVER_NONE &&
           !(handover == AXIS_HANDOVER_ARMED && prepared.state == ARMED);
}

/* The moves are under way, or about to be: as if they had been started. */
static void hand_to_owner(void)
{
    for (unsigned n = 0; n < prepared.count; n++) {
        const struct motion_move *move = &prepared.moves[n];
        struct motion *m = &motions[move->axis];

        motion_take(move->axis, prepared.owner);
        m->move = *move;
        m->leg = 0;
        m->stopping = false;
        m->waiting = false;
        m->end_counts = move->target_counts;
    }
    prepared.begun = true;
}

/* Take the plans back. */
static void drop(void)
{
    for (unsigned n = 0; n < prepared.count; n++)
        (void)axis_plan(prepared.moves[n].axis);
}

void motion_notice_prepared(void)
{
    /* What was fired is its owner's already, and planned again when it was late, as anything is. */
    const bool armed = prepared.state == ARMED;

    if (prepared.state == NOTHING)
        return;
    if (axis_triggers() != prepared.triggers) {
        prepared.state = NOTHING;
        if (armed)
            hand_to_owner();
    } else if (axis_handover(prepared.moves[0].axis) == AXIS_HANDOVER_LATE) {
        prepared.state = NOTHING;
        if (armed)
            drop();
    }
}

void motion_withdraw_prepared(void)
{
    motion_notice_prepared();
    if (prepared.state != ARMED)
        return;
    axis_trigger_watch(false);
    /* The interrupt may have begun them just before; from here on it does not. */
    motion_notice_prepared();
    if (prepared.state == ARMED)
        drop();
    prepared.state = NOTHING;
}

static bool same(const struct motion_move *a, const struct motion_move *b)
{
    bool equal = a->axis == b->axis && a->target_counts == b->target_counts &&
                 a->speed_counts_per_s == b->speed_counts_per_s && a->ramp_ms == b->ramp_ms &&
                 a->via_count == b->via_count;

    for (unsigned n = 0; equal && n < a->via_count; n++)
        equal = a->via_counts[n] == b->via_counts[n];
    return equal;
}

bool motion_is_prepared(void)
{
    motion_notice_prepared();
    if (prepared.state != ARMED)
        return false;
    for (unsigned n = 0; n < prepared.count; n++)
        if (axis_generation(prepared.moves[n].axis) != prepared.generations[n])
            return false;
    return true;
}

static bool is_prepared_like_that(const struct motion_owner *owner,
                                  const struct motion_move *moves, unsigned count)
{
    if (!motion_is_prepared() || owner != prepared.owner || count != prepared.count)
        return false;
    for (unsigned n = 0; n < count; n++)
        if (!same(&moves[n], &prepared.moves[n]) ||
            tuning_jerk_ticks(moves[n].axis) != prepared.jerk_ticks[n])
            return false;
    return true;
}

/* The whole way within the limits: nothing to clip, nor to log, when it begins. */
static bool is_allowed(const struct motion_move *move)
{
    const int32_t from_counts = motion_place_counts(move->axis);
    bool allowed =
        limits_nearest(move->axis, from_counts, move->target_counts) == move->target_counts;

    for (unsigned n = 0; allowed && n < move->via_count; n++)
        allowed = limits_nearest(move->axis, from_counts, move->via_counts[n]) ==
                  move->via_counts[n];
    return allowed;
}

static bool is_possible(const struct motion_owner *owner, const struct motion_move *move)
{
    return motion_stands(move->axis) && motion_ready(move->axis) &&
           motion_may_take(move->axis, owner) && is_allowed(move);
}

bool motion_prepare(const struct motion_owner *owner, const struct motion_move *moves,
                    unsigned count)
{
    if (is_prepared_like_that(owner, moves, count)) {
        axis_trigger_watch(true);
        return true;
    }
    motion_withdraw_prepared();
    if (prepared.state != NOTHING || prepared.begun || count == 0)
        return false;
    for (unsigned n = 0; n < count; n++)
        if (!is_possible(owner, &moves[n]))
            return false;

    prepared.owner = owner;
    prepared.count = count;
    prepared.triggers = axis_triggers();
    for (unsigned n = 0; n < count; n++) {
        const unsigned axis = moves[n].axis;

        prepared.moves[n] = moves[n];
        prepared.jerk_ticks[n] = tuning_jerk_ticks(axis);
        prepared.generations[n] = motion_plan(axis, &prepared.moves[n], axis_ticks());
    }
    for (unsigned n = 0; n < count; n++)
        axis_arm(moves[n].axis, prepared.generations[n], moves[n].via_count == 0);
    prepared.state = ARMED;
    axis_trigger_watch(true);
    return true;
}

void motion_unprepare(void)
{
    motion_withdraw_prepared();
}

void motion_doubt_prepared(void)
{
    axis_trigger_hold();
}

bool motion_trigger(void)
{
    motion_notice_prepared();
    if (motion_is_prepared() && !prepared.begun) {
        hand_to_owner();
        prepared.state = FIRED;
        axis_trigger_fire();
    }

    const bool begun = prepared.begun;
    prepared.begun = false;
    return begun;
}
