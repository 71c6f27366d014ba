/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/loop.h"

/* The set-point stands once the place expected is this near it: half a count. */
#define STANDS_Q16 32768

static int32_t magnitude(int32_t value)
{
    return value >= 0 ? value : value == INT32_MIN ? INT32_MAX : -value;
}

static void enter(struct loop_state *st, enum loop_mode mode)
{
    st->mode = (uint8_t)mode;
    st->mode_turns = 0;
    st->dead_turns = 0;
    st->away_turns = 0;
    st->near_turns = 0;
    st->nearest_counts = INT32_MAX;
    st->vain_turns = 0;
    if (mode == LOOP_TRACK)
        return;
    st->held_steps = 0;
    st->held_ticks = 0;
    st->regulated = false;
    if (mode == LOOP_SETTLE || mode == LOOP_WAIT)
        return;
    st->behind = false;
    st->commanded = false;
}

void loop_configure(struct loop_state *st, const struct loop_config *cfg)
{
    st->rates = cfg->pid.rates;
    st->lag_q31 = cfg->lag_q31;
}

void loop_free(struct loop_state *st, enum loop_fault fault)
{
    enter(st, LOOP_FREE);
    st->fault = (uint8_t)fault;
    st->still_turns = 0;
    st->lag_q16 = 0;
}

void loop_rest(struct loop_state *st)
{
    enter(st, LOOP_IDLE);
    st->fault = LOOP_NO_FAULT;
    st->lag_q16 = 0;
}

void loop_spin(struct loop_state *st, int32_t duty_steps)
{
    if (st->mode != LOOP_SPIN)
        enter(st, LOOP_SPIN);
    st->lag_q16 = 0;
    st->held_steps = duty_steps;
}

static void start(const struct loop_config *cfg, struct loop_state *st, enum loop_mode mode,
                  int32_t error_q16)
{
    pid_reset(&st->pid, error_q16);
    nudge_reset(&cfg->nudge, &st->nudge);
    enter(st, mode);
}

void loop_track(const struct loop_config *cfg, struct loop_state *st, bool commanded)
{
    if (st->mode != LOOP_TRACK) {
        start(cfg, st, LOOP_TRACK, pid_clamp(st->error_counts, 4000) * 65536);
        st->pid.feed_q4 = 0;
        st->regulated = true;
    }
    st->commanded = commanded;
}

/* Whether a settling has gone on for too long. */
static bool is_in_vain(const struct loop_config *cfg, struct loop_state *st, int32_t distance)
{
    if (distance < st->nearest_counts) {
        st->nearest_counts = distance;
        st->vain_turns = 0;
    } else {
        st->vain_turns++;
    }
    if (st->nudge.active)
        st->mode_turns++;
    return cfg->maintain != LOOP_MAINTAIN_FOR_EVER &&
           (st->vain_turns > cfg->settle_limit_turns || st->mode_turns > cfg->settle_limit_turns);
}

static void arrive(const struct loop_config *cfg, struct loop_state *st)
{
    if (cfg->maintain == LOOP_MAINTAIN_HOLD)
        enter(st, LOOP_HOLD);
    else
        enter(st, LOOP_IDLE);
}

static void settled(const struct loop_config *cfg, struct loop_state *st)
{
    bool pause = st->commanded && cfg->wait_turns > 0;

    if (cfg->maintain == LOOP_MAINTAIN_RELEASE)
        st->commanded = false;
    if (pause)
        enter(st, LOOP_WAIT);
    else
        arrive(cfg, st);
}

/* The mode for this turn, from the last one's and what is seen now. */
static void decide(const struct loop_config *cfg, struct loop_state *st, bool moving,
                   int32_t error_q16)
{
    int32_t distance = magnitude(st->error_counts);
    bool near = distance <= cfg->finish_counts;

    if (st->mode == LOOP_FREE || st->mode == LOOP_SPIN || moving)
        return;
    switch (st->mode) {
    case LOOP_IDLE:
        if (distance > cfg->drift_counts && cfg->maintain != LOOP_MAINTAIN_DISENGAGE)
            start(cfg, st, LOOP_SETTLE, error_q16);
        break;
    case LOOP_TRACK:
        nudge_reset(&cfg->nudge, &st->nudge);
        enter(st, LOOP_SETTLE);
        break;
    case LOOP_SETTLE:
        st->near_turns = near ? st->near_turns + 1 : 0;
        if (st->near_turns >= (cfg->maintain == LOOP_MAINTAIN_RELEASE ? 1 : cfg->settle_turns))
            settled(cfg, st);
        else if (is_in_vain(cfg, st, distance))
            loop_free(st, LOOP_NOT_SETTLED);
        break;
    case LOOP_WAIT:
        if ((!st->commanded && cfg->maintain != LOOP_MAINTAIN_RELEASE) ||
            ++st->mode_turns >= cfg->wait_turns)
            arrive(cfg, st);
        break;
    default:
        break;
    }
}

/* Bring a standing set-point and the axis together: let go, nudge, or regulate. */
static void settle(const struct loop_config *cfg, struct loop_state *st, int32_t error_q16)
{
    int32_t distance = magnitude(st->error_counts), nudge_steps;

    st->regulated = false;
    if (distance <= cfg->finish_counts) {
        pid_reset(&st->pid, error_q16);
        st->held_steps = 0;
        return;
    }
    if (distance > cfg->nudge.reach_counts)
        st->nudge.active = false;
    else if (st->still_turns >= cfg->nudge.rest_turns)
        st->nudge.active = true;
    if (!st->nudge.active) {
        st->regulated = true;
        return;
    }
    pid_reset(&st->pid, error_q16);
    nudge_steps = nudge_turn(&cfg->nudge, &st->nudge, st->error_counts, st->position_counts,
                             st->still_turns);
    if (nudge_steps != 0) {
        st->held_steps = nudge_steps;
        st->held_ticks = cfg->nudge.pulse_ticks;
    }
}

/* HOLD: against whatever pushes. Within the finish error the drive stays what it took to get there. */
static void hold(const struct loop_config *cfg, struct loop_state *st, int32_t error_q16)
{
    st->regulated = magnitude(st->error_counts) > cfg->finish_counts;
    if (st->regulated)
        return;
    st->held_steps = st->pid.integral_q14 / 16384;
    st->pid.smooth_q16 = pid_clamp(error_q16, PID_ERROR_LIMIT_Q16);
}

/* Let go of an axis that does not obey: its encoder or motor is not what the loop takes it for. */
static void supervise(const struct loop_config *cfg, struct loop_state *st, int32_t moved_counts)
{
    bool full = magnitude(st->duty_steps) >= cfg->pid.output_limit_steps;
    bool far = magnitude(st->error_counts) > cfg->runaway_counts;

    if (full && magnitude(st->error_counts) > cfg->behind_counts)
        st->behind = true;
    else if (magnitude(st->error_counts) <= cfg->behind_counts / 2)
        st->behind = false;

    if (!full || (uint32_t)st->position_counts - (uint32_t)st->dead_counts + LOOP_DEAD_COUNTS >
                     2 * LOOP_DEAD_COUNTS) {
        st->dead_turns = 0;
        st->dead_counts = st->position_counts;
    } else {
        st->dead_turns++;
    }

    if (!far)
        st->away_turns = 0;
    else if (moved_counts != 0 && (moved_counts > 0) != (st->error_counts > 0))
        st->away_turns++;
    else if (st->away_turns > 0)
        st->away_turns--;

    if (magnitude(st->error_counts) > LOOP_ERROR_MAX)
        loop_free(st, LOOP_OVERFLOW);
    else if (st->away_turns > cfg->runaway_turns)
        loop_free(st, LOOP_RUNAWAY);
    else if (st->dead_turns > cfg->dead_turns)
        loop_free(st, LOOP_DEAD);
}

static void feed(const struct loop_config *cfg, struct loop_state *st,
                 const struct profile_state *profile, int32_t error_q16, bool may_fall,
                 bool may_rise)
{
    /* Acceleration with 20 fraction bits. */
    pid_feed(&cfg->pid, &st->pid, error_q16, (int32_t)(profile->step_q48 >> 32),
             (int32_t)(profile->change_q48 >> 28), may_fall, may_rise);
}

void loop_feed(const struct loop_config *cfg, struct loop_state *st,
               const struct profile_state *profile, bool may_fall, bool may_rise)
{
    feed(cfg, st, profile, loop_error_q16(st, profile, st->position_counts), may_fall, may_rise);
}

void loop_jump(const struct loop_config *cfg, struct loop_state *st,
               const struct profile_state *profile, bool may_fall, bool may_rise)
{
    if (st->mode == LOOP_TRACK)
        return;
    if (st->mode == LOOP_SETTLE && st->regulated) {
        st->mode_turns = 0;
        st->near_turns = 0;
        st->nearest_counts = INT32_MAX;
        st->vain_turns = 0;
        nudge_reset(&cfg->nudge, &st->nudge);
    } else {
        start(cfg, st, LOOP_SETTLE, pid_clamp(st->error_counts, 4000) * 65536);
        st->regulated = true;
        loop_feed(cfg, st, profile, may_fall, may_rise);
    }
    /* It has all the time to follow before it is nudged. */
    st->still_turns = 0;
}

void loop_turn(const struct loop_config *cfg, struct loop_state *st,
               const struct profile_state *profile, int32_t position_counts, int32_t duty_steps,
               bool may_fall, bool may_rise)
{
    int32_t moved_counts = (int32_t)((uint32_t)position_counts - (uint32_t)st->position_counts);
    int32_t error_q16 = loop_error_q16(st, profile, position_counts);
    bool moving = profile_moving(profile) || magnitude(st->lag_q16) > STANDS_Q16;

    if (!moving)
        st->lag_q16 = 0;
    st->position_counts = position_counts;
    st->duty_steps = duty_steps;
    st->error_counts = (int32_t)((uint32_t)(profile->position_q32 >> 32) -
                                 (uint32_t)(st->lag_q16 >> 16) - (uint32_t)position_counts);
    if (moved_counts != 0)
        st->still_turns = 0;
    else if (st->still_turns < UINT32_MAX)
        st->still_turns++;

    if (st->mode > LOOP_IDLE)
        supervise(cfg, st, moved_counts);
    decide(cfg, st, moving, error_q16);
    if (st->mode == LOOP_HOLD)
        hold(cfg, st, error_q16);
    else if (st->mode >= LOOP_SETTLE)
        settle(cfg, st, error_q16);
    if (st->regulated)
        feed(cfg, st, profile, error_q16, may_fall, may_rise);
    else if (st->held_steps > 0 ? !may_rise : !may_fall)
        st->held_steps = 0;
}
