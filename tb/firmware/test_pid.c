/* SPDX-License-Identifier: BSD-2-Clause */
/* The controller's integers against the same law in floating point and physical units. */
#include "check.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "servo/loop.h"

static double uniform(double low, double high)
{
    return low + (high - low) * (rand() / (double)RAND_MAX);
}

static int32_t any(void)
{
    return (int32_t)((uint32_t)rand() << 16 ^ (uint32_t)rand());
}

static const struct pid_gains defaults = {
    .kp = 160, .ki = 150, .kd = 140, .kv = 106, .ka = 93, .friction_steps = 250,
    .approach_per_s = 300, .knee_counts_per_s = 150, .derivative_filter_us = 400,
    .output_limit_steps = 2500,
};

/* The law as the header states it, in steps, counts and ms. */
struct reference {
    const struct pid_gains *g;
    double tick_ms, integral, error, rate;
};

static double clamp(double value, double limit)
{
    return fmax(-limit, fmin(limit, value));
}

static double reference_tick(struct reference *r, double error, double velocity,
                             double acceleration)
{
    const struct pid_gains *g = r->g;
    double wanted = velocity + g->approach_per_s / 1000.0 * clamp(error, 16);
    double share = r->tick_ms / (r->tick_ms + g->derivative_filter_us / 1000.0), out;

    r->rate += share * ((error - r->error) / r->tick_ms - r->rate);
    r->error = error;
    out = g->kp / 64.0 * error + r->integral + g->kd / 8.0 * r->rate + g->kv / 16.0 * velocity +
          g->ka / 2.0 * acceleration +
          g->friction_steps * clamp(wanted / (g->knee_counts_per_s / 1000.0), 1);
    if (fabs(out) <= g->output_limit_steps || out * error < 0)
        r->integral =
            clamp(r->integral + g->ki / 1024.0 * error * r->tick_ms, g->output_limit_steps);
    return clamp(out, g->output_limit_steps);
}

/* Feed-forward anew and a tick. */
static int32_t pid(const struct pid_config *cfg, struct pid_state *st, int32_t error_q16,
                   int32_t velocity_q16, int32_t acceleration_q20)
{
    pid_feed(cfg, st, error_q16, velocity_q16, acceleration_q20, true, true);
    return pid_tick(&cfg->rates, st, error_q16);
}

/* Random smooth motion with noise of a count; every output within a step and a permille. */
static bool agrees(const struct pid_gains *g, uint32_t period_us, double most)
{
    struct pid_config cfg;
    struct pid_state st;
    struct reference r = {.g = g, .tick_ms = period_us / 1000.0};
    double worst = 0;

    pid_configure(&cfg, g, period_us);
    pid_reset(&st, 0);
    for (int n = 0; n < 4000; n++) {
        double t = n * r.tick_ms, velocity = 30 * sin(t / 50), acceleration = 0.6 * cos(t / 50);
        double error = floor((most * sin(t / 17) + uniform(-1, 1)) * 256) / 256;
        int32_t out = pid(&cfg, &st, (int32_t)(error * 65536),
                          (int32_t)lround(velocity * r.tick_ms * 65536),
                          (int32_t)lround(acceleration * r.tick_ms * r.tick_ms * 1048576));

        worst = fmax(worst, fabs(out - reference_tick(&r, error, velocity, acceleration)));
    }
    if (worst > 2.5)
        printf("# off by %g steps\n", worst);
    return worst <= 2.5;
}

TEST(follows_its_law_at_the_default_gains)
{
    srand(1);
    CHECK(agrees(&defaults, 100, 3));
    CHECK(agrees(&defaults, 100, 300));
}

TEST(follows_its_law_at_other_periods)
{
    srand(2);
    CHECK(agrees(&defaults, 50, 30));
    CHECK(agrees(&defaults, 200, 30));
    CHECK(agrees(&defaults, 250, 30));
    CHECK(agrees(&defaults, 1000, 30));
}

TEST(each_term_acts_alone)
{
    srand(3);
    for (int term = 0; term < 6; term++) {
        struct pid_gains g = {.output_limit_steps = 2500, .knee_counts_per_s = 150,
                              .derivative_filter_us = 400, .approach_per_s = 300};
        int32_t *const gains[] = {&g.kp, &g.ki, &g.kd, &g.kv, &g.ka, &g.friction_steps};

        *gains[term] = 200;
        CHECK(agrees(&g, 100, 20));
    }
}

TEST(output_and_integral_keep_their_limit)
{
    struct pid_config cfg;
    struct pid_state st;

    pid_configure(&cfg, &defaults, 100);
    pid_reset(&st, 0);
    for (int n = 0; n < 20000; n++) {
        CHECK(pid(&cfg, &st, 1000 * 65536, 0, 0) <= 2500);
        CHECK(st.integral_q14 <= 2500 * 16384);
    }
    CHECK_INT(pid(&cfg, &st, 1000 * 65536, 0, 0), 2500);
    CHECK_INT(pid(&cfg, &st, -1000 * 65536, 0, 0), -2500);
}

TEST(a_clamped_output_does_not_wind_up)
{
    struct pid_config cfg;
    struct pid_state st;

    pid_configure(&cfg, &defaults, 100);
    pid_reset(&st, 2000 * 65536);
    for (int n = 0; n < 50000; n++)
        CHECK_INT(pid(&cfg, &st, 2000 * 65536, 0, 0), 2500);
    CHECK(st.integral_q14 < 100 * 16384);
}

TEST(no_argument_overflows)
{
    srand(4);
    for (int i = 0; i < 3000; i++) {
        struct pid_gains g = {any(), any(), any(), any(), any(), any(), any(), any(), any(), any()};
        struct pid_config cfg;
        struct pid_state st;
        uint32_t period_us = (uint32_t)any() % (i % 2 ? 300 : 20000);

        pid_configure(&cfg, &g, period_us);
        pid_reset(&st, any());
        for (int n = 0; n < 50; n++) {
            int32_t extremes[] = {INT32_MAX, INT32_MIN, 0, any()};
            int32_t error = pid_clamp(extremes[rand() % 4], PID_ERROR_LIMIT_Q16), out;

            if (n % 4 == 0)
                pid_feed(&cfg, &st, extremes[rand() % 4], extremes[rand() % 4],
                         extremes[rand() % 4], rand() % 2, rand() % 2);
            out = pid_tick(&cfg.rates, &st, error);

            CHECK(abs(out) <= cfg.output_limit_steps && cfg.output_limit_steps <= 8191);
        }
    }
}

/* Toward a closed switch it does not drive, nor wind up. */
TEST(the_output_keeps_to_its_side)
{
    struct pid_config cfg;
    struct pid_state st;

    pid_configure(&cfg, &defaults, 100);
    pid_reset(&st, 0);
    for (int n = 0; n < 2000; n++) {
        pid_feed(&cfg, &st, 50 * 65536, 65536, 0, true, false);
        CHECK_INT(pid_tick(&cfg.rates, &st, 50 * 65536), 0);
    }
    CHECK(st.integral_q14 < 100 * 16384);
    pid_feed(&cfg, &st, -50 * 65536, -65536, 0, true, false);
    CHECK(pid_tick(&cfg.rates, &st, -50 * 65536) < -200);
    pid_feed(&cfg, &st, -50 * 65536, -65536, 0, false, true);
    CHECK_INT(pid_tick(&cfg.rates, &st, -50 * 65536), 0);
}

TEST(the_loop_takes_any_position_and_set_point)
{
    struct loop_config cfg = {
        .lag_q31 = 300000000, .finish_counts = 1, .drift_counts = 18, .runaway_counts = 90000,
        .runaway_turns = 50, .dead_turns = 500, .settle_turns = 10, .settle_limit_turns = 2500,
        .nudge = {24, 1000, 2500, 2, 4},
    };

    srand(5);
    pid_configure(&cfg.pid, &defaults, 100);
    for (int i = 0; i < 2000; i++) {
        struct loop_state st = {0};
        struct profile_state profile;

        loop_configure(&st, &cfg);
        loop_rest(&st);
        for (int n = 0; n < 30; n++) {
            int32_t places[] = {INT32_MAX, INT32_MIN, 0, any(), st.position_counts};
            int32_t place = places[rand() % 5], duty;

            if (rand() % 4 == 0 && st.mode > LOOP_SPIN)
                loop_track(&cfg, &st, rand() % 2);
            profile_rest(&profile, places[rand() % 5] * (INT64_C(1) << 32) + (uint32_t)any());
            profile.step_q48 = (int64_t)any() * (INT64_C(1) << rand() % 32);
            profile.change_q48 = any();
            duty = loop_tick(&st, &profile, place);
            CHECK(abs(duty) <= 2500);
            loop_turn(&cfg, &st, &profile, place, duty, rand() % 2, rand() % 2);
        }
    }
}

/* The place expected follows a moving set-point by its speed times the lag, and catches up. */
TEST(the_axis_is_expected_a_lag_behind_the_set_point)
{
    struct loop_config cfg = {.lag_q31 = (int32_t)(2147483648.0 / 7), .drift_counts = 18};
    struct loop_state st = {0};
    struct profile_state profile;

    pid_configure(&cfg.pid, &defaults, 100);
    loop_configure(&st, &cfg);
    loop_rest(&st);
    loop_track(&cfg, &st, true);
    profile_rest(&profile, 0);
    profile.step_q48 = 5 * (INT64_C(1) << 48);
    for (int n = 0; n < 300; n++)
        (void)loop_tick(&st, &profile, 0);
    /* A low-pass of share s lags by (1 - s) / s ticks. */
    CHECK(fabs(st.lag_q16 / 65536.0 - 5 * 6) < 0.01);
    profile.step_q48 = 0;
    for (int n = 0; n < 300; n++)
        (void)loop_tick(&st, &profile, 0);
    CHECK(fabs(st.lag_q16 / 65536.0) < 0.001);
}

TEST(nudges_grow_until_the_axis_moves_and_shrink_when_it_went_too_far)
{
    static const struct nudge_config cfg = {
        .reach_counts = 24, .first_steps = 1000, .limit_steps = 2500, .pulse_ticks = 2,
        .rest_turns = 4,
    };
    struct nudge_state st;
    int32_t last = 0, position = 0;

    nudge_reset(&cfg, &st);
    CHECK_INT(nudge_turn(&cfg, &st, 3, position, 3), 0);
    for (int pulse = 0; pulse < 20; pulse++) {
        int32_t steps = nudge_turn(&cfg, &st, 3, position, 100);

        CHECK(steps > last || steps == 2500);
        CHECK(pulse > 0 || steps == 1000);
        last = steps;
        for (int rest = 0; rest < 4; rest++)
            CHECK_INT(nudge_turn(&cfg, &st, 3, position, 100), 0);
    }
    CHECK_INT(last, 2500);
    position = 5;
    CHECK_INT(nudge_turn(&cfg, &st, -2, position, 100), -1875);
}

TEST_MAIN(RUN(follows_its_law_at_the_default_gains);
          RUN(follows_its_law_at_other_periods);
          RUN(each_term_acts_alone);
          RUN(output_and_integral_keep_their_limit);
          RUN(a_clamped_output_does_not_wind_up);
          RUN(no_argument_overflows);
          RUN(the_output_keeps_to_its_side);
          RUN(the_loop_takes_any_position_and_set_point);
          RUN(the_axis_is_expected_a_lag_behind_the_set_point);
          RUN(nudges_grow_until_the_axis_moves_and_shrink_when_it_went_too_far))
