/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/loop.h"

static int32_t magnitude(int32_t value)
{
    return value >= 0 ? value : value == INT32_MIN ? INT32_MAX : -value;
}

static void enter(struct loop_state *st, enum loop_mode mode)
{
    st->mode = mode;
    st->mode_ticks = 0;
    st->dead_ticks = 0;
    st->away_ticks = 0;
    st->near_ticks = 0;
    st->nearest_counts = INT32_MAX;
    st->vain_ticks = 0;
    if (mode == LOOP_IDLE || mode == LOOP_FREE) {
        st->behind = false;
        st->commanded = false;
    }
}

void loop_free(struct loop_state *st, enum loop_fault fault)
{
    enter(st, LOOP_FREE);
    st->fault = fault;
    st->still_ticks = 0;
    st->duty_steps = 0;
}

void loop_rest(struct loop_state *st)
{
    enter(st, LOOP_IDLE);
    st->fault = LOOP_NO_FAULT;
}

static void start(const struct loop_config *cfg, struct loop_state *st, enum loop_mode mode,
                  int32_t error_q8)
{
    pid_reset(&st->pid, error_q8);
    nudge_reset(&cfg->nudge, &st->nudge);
    enter(st, mode);
}

/* Whether a settling has gone on for too long. */
static bool is_in_vain(const struct loop_config *cfg, struct loop_state *st, int32_t distance)
{
    if (distance < st->nearest_counts) {
        st->nearest_counts = distance;
        st->vain_ticks = 0;
    } else {
        st->vain_ticks++;
    }
    if (st->nudge.active)
        st->mode_ticks++;
    return st->vain_ticks > cfg->settle_limit_ticks || st->mode_ticks > cfg->settle_limit_ticks;
}

/* The mode for this tick, from the last one's and what is seen now. */
static void decide(const struct loop_config *cfg, struct loop_state *st, bool moving,
                   int32_t error_q8)
{
    int32_t distance = magnitude(st->error_counts);
    bool near = distance <= cfg->finish_counts;

    if (st->mode == LOOP_FREE)
        return;
    if (moving) {
        if (st->mode != LOOP_TRACK)
            start(cfg, st, LOOP_TRACK, error_q8);
        return;
    }
    switch (st->mode) {
    case LOOP_IDLE:
        /* A commanded motion of no length arrives by way of SETTLE as any other. */
        if (st->commanded || distance > cfg->drift_counts)
            start(cfg, st, LOOP_SETTLE, error_q8);
        break;
    case LOOP_TRACK:
        nudge_reset(&cfg->nudge, &st->nudge);
        enter(st, LOOP_SETTLE);
        break;
    case LOOP_SETTLE:
        st->near_ticks = near ? st->near_ticks + 1 : 0;
        if (st->near_ticks >= cfg->settle_ticks)
            enter(st, st->commanded && cfg->wait_ticks > 0 ? LOOP_WAIT : LOOP_IDLE);
        else if (is_in_vain(cfg, st, distance))
            loop_free(st, LOOP_NOT_SETTLED);
        break;
    case LOOP_WAIT:
        if (!st->commanded || ++st->mode_ticks >= cfg->wait_ticks)
            enter(st, LOOP_IDLE);
        break;
    case LOOP_FREE:
        break;
    }
}

/* Bring a standing set-point and the axis together: let go, nudge, or regulate. */
static int32_t settle(const struct loop_config *cfg, struct loop_state *st, int32_t error_q8)
{
    int32_t distance = magnitude(st->error_counts);

    if (distance <= cfg->finish_counts) {
        pid_reset(&st->pid, error_q8);
        return 0;
    }
    if (distance > cfg->nudge.reach_counts)
        st->nudge.active = false;
    else if (st->still_ticks >= cfg->nudge.rest_ticks)
        st->nudge.active = true;
    if (!st->nudge.active)
        return pid_tick(&cfg->pid, &st->pid, error_q8, 0, 0);
    pid_reset(&st->pid, error_q8);
    return nudge_tick(&cfg->nudge, &st->nudge, st->error_counts, st->position_counts,
                      st->still_ticks);
}

/* Note when the motor cannot follow. Let go of an axis that does not obey: its encoder or motor is
 * not what the loop takes it for. */
static void supervise(const struct loop_config *cfg, struct loop_state *st, int32_t moved_counts)
{
    bool full = magnitude(st->duty_steps) >= cfg->pid.output_limit_steps;
    bool far = magnitude(st->error_counts) > cfg->runaway_counts;

    if (full && magnitude(st->error_counts) > cfg->behind_counts)
        st->behind = true;
    else if (magnitude(st->error_counts) <= cfg->behind_counts / 2)
        st->behind = false;
    st->dead_ticks = full && moved_counts == 0 ? st->dead_ticks + 1 : 0;
    if (!far)
        st->away_ticks = 0;
    else if (moved_counts != 0 && (moved_counts > 0) != (st->error_counts > 0))
        st->away_ticks++;
    else if (st->away_ticks > 0)
        st->away_ticks--;

    if (st->away_ticks > cfg->runaway_ticks)
        loop_free(st, LOOP_RUNAWAY);
    else if (st->dead_ticks > cfg->dead_ticks)
        loop_free(st, LOOP_DEAD);
}

/* Note this tick's set-point; return the one of lead_ticks ago. */
static int64_t delayed_q32(const struct loop_config *cfg, struct loop_state *st,
                           const struct profile_state *profile)
{
    if (profile_moving(profile))
        st->late_ticks = cfg->lead_ticks + 1;
    else if (st->late_ticks > 0)
        st->late_ticks--;
    st->newest = (st->newest + 1) % LOOP_LEAD_TICKS;
    st->setpoint_q32[st->newest] = profile->now.position_q32;
    return st->setpoint_q32[(st->newest - cfg->lead_ticks) % LOOP_LEAD_TICKS];
}

/* Set-point minus position: whole counts to st->error_counts, and with 8 fraction bits, clamped. In
 * 32 bits: the difference of two positions wraps like the encoder's counter. */
static int32_t take_error_q8(struct loop_state *st, int64_t setpoint_q32, int32_t position_counts)
{
    uint32_t whole = (uint32_t)(setpoint_q32 >> 32) - (uint32_t)position_counts;
    int32_t fraction_q8 = (int32_t)((uint32_t)setpoint_q32 >> 24);

    st->error_counts = (int32_t)whole;
    return pid_clamp(st->error_counts, PID_ERROR_LIMIT_Q8 / 256) * 256 + fraction_q8;
}

int32_t loop_tick(const struct loop_config *cfg, struct loop_state *st,
                  const struct profile_state *profile, int32_t position_counts)
{
    int32_t moved_counts = (int32_t)((uint32_t)position_counts - (uint32_t)st->position_counts);
    int32_t error_q8 = take_error_q8(st, delayed_q32(cfg, st, profile), position_counts);

    st->position_counts = position_counts;
    if (moved_counts != 0)
        st->still_ticks = 0;
    else if (st->still_ticks < UINT32_MAX)
        st->still_ticks++;

    if (st->mode != LOOP_FREE && st->mode != LOOP_IDLE)
        supervise(cfg, st, moved_counts);
    decide(cfg, st, st->late_ticks > 0, error_q8);
    switch (st->mode) {
    case LOOP_FREE:
    case LOOP_IDLE:
        st->duty_steps = 0;
        break;
    case LOOP_SETTLE:
    case LOOP_WAIT:
        st->duty_steps = settle(cfg, st, error_q8);
        break;
    case LOOP_TRACK:
        /* Acceleration with 20 fraction bits is twice the half with 21. */
        st->duty_steps = pid_tick(&cfg->pid, &st->pid, error_q8,
                                  (int32_t)(profile->now.velocity_q32 >> 16),
                                  (int32_t)(profile->half_acceleration_q32 >> 11));
        break;
    }
    return st->duty_steps;
}
