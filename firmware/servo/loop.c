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
    st->near_ticks = 0;
    if (mode == LOOP_IDLE || mode == LOOP_FREE)
        st->commanded = false;
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

/* The mode for this tick, from the last one's and what is seen now. */
static void decide(const struct loop_config *cfg, struct loop_state *st, bool moving, int32_t error_q8)
{
    int32_t distance = magnitude(st->error_counts);

    if (st->mode == LOOP_FREE)
        return;
    if (st->mode != LOOP_IDLE && distance > cfg->error_limit_counts) {
        loop_free(st, LOOP_LOST);
        return;
    }
    if (moving) {
        if (st->mode == LOOP_IDLE)
            pid_reset(&st->pid, error_q8);
        if (st->mode != LOOP_TRACK)
            enter(st, LOOP_TRACK);
        return;
    }
    switch (st->mode) {
    case LOOP_IDLE:
        if (distance > cfg->drift_counts) {
            pid_reset(&st->pid, error_q8);
            enter(st, LOOP_SETTLE);
        } else if (st->commanded) {
            pid_reset(&st->pid, error_q8);
            enter(st, LOOP_SETTLE);
            st->commanded = true;
        }
        break;
    case LOOP_TRACK:
        enter(st, LOOP_SETTLE);
        break;
    case LOOP_SETTLE:
        st->near_ticks = distance <= cfg->finish_counts ? st->near_ticks + 1 : 0;
        if (st->near_ticks >= cfg->settle_ticks)
            enter(st, st->commanded && cfg->wait_ticks > 0 ? LOOP_WAIT : LOOP_IDLE);
        else if (++st->mode_ticks > cfg->settle_limit_ticks)
            loop_free(st, LOOP_NOT_SETTLED);
        break;
    case LOOP_WAIT:
        if (++st->mode_ticks >= cfg->wait_ticks)
            enter(st, LOOP_IDLE);
        break;
    case LOOP_FREE:
        break;
    }
}

int32_t loop_tick(const struct loop_config *cfg, struct loop_state *st, const struct profile_state *profile,
                  int32_t position_counts)
{
    /* Subtract with 8 fraction bits: both terms are below 2^40 whatever the set-point, so nothing overflows. */
    int64_t error_q8 = (profile->now.position_q32 >> 24) - (int64_t)position_counts * 256;
    int32_t clamped_q8 = (int32_t)pid_clamp(error_q8, PID_ERROR_LIMIT_Q8);

    st->error_counts = (int32_t)pid_clamp(error_q8 / 256, INT32_MAX);
    if (position_counts != st->position_counts)
        st->still_ticks = 0;
    else if (st->still_ticks < UINT32_MAX)
        st->still_ticks++;
    st->position_counts = position_counts;

    decide(cfg, st, profile_moving(profile), clamped_q8);
    if (st->mode == LOOP_FREE || st->mode == LOOP_IDLE) {
        st->duty_steps = 0;
        return 0;
    }
    st->duty_steps = pid_tick(&cfg->pid, &st->pid, clamped_q8, (int32_t)(profile->now.velocity_q32 >> 16),
                              (int32_t)((2 * profile->half_acceleration_q32) >> 12));
    return st->duty_steps;
}
