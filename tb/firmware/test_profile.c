/* SPDX-License-Identifier: BSD-2-Clause */
/* Set-point plans, stepped tick by tick, against the laws of motion and closed-form times. */
#include "check.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "servo/profile.h"

static const double ONE = 4294967296.0;
static const double ONE_Q48 = 281474976710656.0;

/* A position is rounded to 2^-32 each tick, a change of speed to 2^-48 once. */
static double rounding(uint64_t ticks)
{
    double n = (double)ticks;

    return n / ONE + n * n / ONE_Q48 + 1e-6;
}

static double velocity(const struct profile_point *point)
{
    return (double)point->velocity_q48 / ONE_Q48;
}

static double uniform(double low, double high)
{
    return low + (high - low) * (rand() / (double)RAND_MAX);
}

/* Log-uniform, so that slow and fast, short and long are tried alike. */
static double decades(double low, double high)
{
    return exp(uniform(log(low), log(high)));
}

static struct profile_point point(double position, double speed)
{
    return (struct profile_point){
        .position_q32 = llround(position) * (INT64_C(1) << 32),
        .velocity_q48 = llround(speed * ONE) * 65536,
    };
}

struct trial {
    struct profile_point start;
    int64_t target_q32;
    double speed, acceleration, jerk_ticks;
};

static struct trial random_trial(bool moving)
{
    double speed = decades(1e-4, 100.0), ramp = decades(1.0, 3000.0);
    double distance = (rand() % 2 ? 1 : -1) * decades(1.0, speed * 20000.0 + 2.0);
    struct trial t = {
        .start = point(uniform(-1e6, 1e6), moving ? uniform(-1.5, 1.5) * speed : 0.0),
        .speed = speed,
        .acceleration = speed / ramp,
    };

    t.target_q32 = t.start.position_q32 + llround(distance) * (INT64_C(1) << 32);
    return t;
}

static struct profile_bounds bounds(const struct trial *t)
{
    return (struct profile_bounds){t->speed, t->acceleration, t->jerk_ticks};
}

static void plan(struct profile_plan *p, const struct trial *t)
{
    struct profile_bounds b = bounds(t);

    profile_plan_move(p, &t->start, t->target_q32, &b);
}

TEST(ends_on_its_target_at_rest)
{
    srand(1);
    for (int i = 0; i < 300; i++) {
        struct trial t = random_trial(i % 2);
        struct profile_plan p;
        struct profile_state st;
        uint64_t ticks;

        t.jerk_ticks = i % 3 == 0 ? uniform(0, 300) : 0;
        plan(&p, &t);
        ticks = profile_ticks(&p);
        profile_rest(&st, t.start.position_q32);
        profile_begin(&st, &p);
        for (uint64_t n = 0; n < ticks; n++) {
            CHECK(profile_moving(&st));
            profile_tick(&st);
        }
        CHECK(!profile_moving(&st));
        CHECK(st.position_q32 == t.target_q32 && st.step_q48 == 0 && st.change_q48 == 0);
        profile_tick(&st);
        CHECK(st.position_q32 == t.target_q32);
    }
}

TEST(begins_where_it_was_planned_from)
{
    srand(2);
    for (int i = 0; i < 300; i++) {
        struct trial t = random_trial(true);
        struct profile_plan p;
        struct profile_point first;
        double late;

        plan(&p, &t);
        first = profile_at(&p, 0);
        CHECK(first.position_q32 == t.start.position_q32);
        late = fabs((double)(first.velocity_q48 - t.start.velocity_q48)) / ONE_Q48;
        CHECK(late <= 2.0 / ONE);
    }
}

/* Between two ticks the speed changes by at most the acceleration, and the position by at most the
 * speed; beyond the limit only while an excessive speed is being braked. */
TEST(keeps_speed_and_acceleration)
{
    srand(3);
    for (int i = 0; i < 200; i++) {
        struct trial t = random_trial(i % 2);
        struct profile_plan p;
        struct profile_state st;
        double before = velocity(&t.start);
        double allowed = fmax(t.speed, fabs(before));

        plan(&p, &t);
        profile_rest(&st, t.start.position_q32);
        profile_begin(&st, &p);
        while (profile_moving(&st)) {
            int64_t from = st.position_q32;
            struct profile_point now;
            double speed, step;

            profile_tick(&st);
            now = profile_now(&st);
            speed = velocity(&now);
            step = (double)(now.position_q32 - from) / ONE;
            CHECK(fabs(speed) <= allowed * (1 + 1e-9) + rounding(1));
            CHECK(fabs(speed - before) <= t.acceleration * (1 + 1e-6) + rounding(1));
            /* Constant acceleration in between, or a corner: the mean speed lies within reach. */
            CHECK(fabs(step - (speed + before) / 2) <= t.acceleration / 2 + rounding(3000));
            before = speed;
            if (fabs(speed) <= t.speed)
                allowed = t.speed;
        }
    }
}

TEST(takes_no_longer_than_a_trapezoid)
{
    srand(4);
    for (int i = 0; i < 300; i++) {
        struct trial t = random_trial(false);
        struct profile_plan p;
        double distance = fabs((double)(t.target_q32 - t.start.position_q32)) / ONE;
        double v = t.speed, a = t.acceleration;
        double ticks = distance > v * v / a ? distance / v + v / a : 2 * sqrt(distance / a);

        plan(&p, &t);
        CHECK(fabs((double)profile_ticks(&p) - ticks) <= 1.0 + 1e-9 * ticks);
        CHECK((double)profile_ticks(&p) >= ticks - 1e-6 * ticks);
    }
}

/* Distance covered after t ticks of the shortest motion from rest to rest. */
static double trapezoid(double distance, double v, double a, double t)
{
    double ramp = fmin(v / a, sqrt(distance / a)), peak = a * ramp;
    double total = ramp + distance / peak;

    if (t <= ramp)
        return a * t * t / 2;
    if (t >= total - ramp)
        return distance - a * (total - t) * (total - t) / 2;
    return peak * (t - ramp / 2);
}

TEST(is_at_each_tick_where_the_laws_of_motion_have_it)
{
    srand(8);
    for (int i = 0; i < 100; i++) {
        struct trial t = random_trial(false);
        struct profile_plan p;
        double distance = (double)(t.target_q32 - t.start.position_q32) / ONE;
        double side = distance < 0 ? -1 : 1;

        plan(&p, &t);
        for (uint64_t n = 0; n < profile_ticks(&p); n += 1 + profile_ticks(&p) / 500) {
            int64_t moved_q32 = profile_at(&p, n).position_q32 - t.start.position_q32;
            double ideal = trapezoid(fabs(distance), t.speed, t.acceleration, (double)n);

            CHECK(fabs((double)moved_q32 / ONE * side - ideal) <
                  rounding(30000) + 1e-9 * fabs(distance));
        }
    }
}

TEST(cruises_at_exactly_the_speed_asked_for)
{
    /* 0.528 mm/s at 45396 counts/mm and 5 kHz, 50 ms ramps, 2 mm. */
    double speed = 0.528 * 45396 / 5000;
    struct trial t = {.start = point(-100, 0), .speed = speed, .acceleration = speed / 250};
    struct profile_plan p;
    uint64_t ticks;

    t.target_q32 = INT64_C(90692) << 32;
    plan(&p, &t);
    ticks = profile_ticks(&p);
    for (uint64_t n = 251; n < ticks - 252; n += 7) {
        struct profile_point now = profile_at(&p, n);
        double ideal = -100 + speed * ((double)n - 125);

        CHECK(fabs(velocity(&now) - speed) < 1 / ONE);
        CHECK(fabs((double)now.position_q32 / ONE - ideal) < 1e-5);
    }
}

TEST(has_no_slowest_speed)
{
    /* 1 nm/s at 45396 counts/mm and 5 kHz is 9.08e-6 counts a tick; a count takes 22 s. */
    double speed = 1e-6 * 45396 / 5000;
    struct trial t = {.start = point(0, 0), .speed = speed, .acceleration = speed / 250};
    struct profile_plan p;
    struct profile_state st;

    t.target_q32 = INT64_C(3) << 32;
    plan(&p, &t);
    profile_rest(&st, 0);
    profile_begin(&st, &p);
    for (int n = 0; n < 200000; n++) {
        int64_t from = st.position_q32;

        profile_tick(&st);
        CHECK(st.position_q32 > from || n == 0);
    }
    CHECK(fabs((double)st.position_q32 / ONE - speed * (200000 - 125)) < 1e-4);
    CHECK(fabs((double)profile_ticks(&p) - (3 / speed + 250)) < 2);
}

TEST(a_speed_that_is_none_lasts_for_ever)
{
    struct trial t = {.start = point(5, 0), .speed = 1e-99, .acceleration = 1e-3, .target_q32 = INT64_C(9) << 32};
    struct profile_plan p;

    plan(&p, &t);
    CHECK(profile_ticks(&p) > INT64_MAX / 2);
    CHECK(profile_at(&p, UINT64_C(1) << 61).position_q32 == t.start.position_q32);
}

TEST(is_predicted_to_the_thousandth_of_a_count)
{
    srand(5);
    for (int i = 0; i < 100; i++) {
        struct trial t = random_trial(i % 2);
        struct profile_plan p;
        struct profile_state st;

        plan(&p, &t);
        profile_rest(&st, t.start.position_q32);
        profile_begin(&st, &p);
        for (uint64_t n = 0; n < profile_ticks(&p) + 2; n++) {
            struct profile_point then = profile_at(&p, n), now = profile_now(&st);

            CHECK(fabs((double)(then.position_q32 - now.position_q32)) < 1e-3 * ONE);
            CHECK(fabs(velocity(&then) - velocity(&now)) < 1e-9);
            profile_tick(&st);
        }
    }
}

TEST(replaces_a_motion_without_a_jump)
{
    srand(6);
    for (int i = 0; i < 200; i++) {
        struct trial t = random_trial(false), next = t;
        struct profile_plan p, q;
        uint64_t at;
        struct profile_point joint;

        plan(&p, &t);
        at = profile_ticks(&p) * (uint64_t)(rand() % 100) / 100;
        joint = profile_at(&p, at);
        next.start = joint;
        /* Of a kind with the first: braking must not lead out of the range of counts. */
        next.speed = t.speed * uniform(0.1, 2);
        next.acceleration = t.acceleration * uniform(0.1, 10);
        next.target_q32 = t.target_q32 + (rand() % 2001 - 1000) * (INT64_C(1) << 32);
        plan(&q, &next);
        CHECK(profile_at(&q, 0).position_q32 == joint.position_q32);
        CHECK(profile_at(&q, profile_ticks(&q)).position_q32 == next.target_q32);
    }
}

TEST(stops_on_a_whole_count_within_the_acceleration)
{
    srand(7);
    for (int i = 0; i < 500; i++) {
        double speed = decades(1e-3, 100), a = speed / decades(1, 1000);
        struct profile_point start = point(uniform(-1e6, 1e6), uniform(-1, 1) * speed);
        struct profile_bounds b = {100, a, 0};
        double u = velocity(&start), brake = u * fabs(u) / (2 * a);
        struct profile_plan p;
        double distance;
        int64_t end;

        start.position_q32 += rand();
        end = profile_stop_q32(&start, &b);
        distance = (double)(end - start.position_q32) / ONE;
        CHECK_INT(end & 0xffffffff, 0);
        CHECK(fabs(distance) >= fabs(brake) - 1e-6 && fabs(distance - brake) <= 1 + 1e-6);
        profile_plan_move(&p, &start, end, &b);
        /* Never backwards, never longer than braking and a count at the last speeds. */
        for (uint64_t n = 0; n < profile_ticks(&p); n++)
            CHECK((double)profile_at(&p, n).velocity_q48 * u >= -1e-6 * ONE_Q48 * fabs(u));
        CHECK((double)profile_ticks(&p) <= fabs(u) / a + 2 * sqrt(1 / a) + 2);
    }
}

/* The third difference of the positions is the jerk; the limits of the others hold as well. */
TEST(keeps_its_jerk)
{
    srand(9);
    for (int i = 0; i < 200; i++) {
        struct trial t = random_trial(false);
        struct profile_plan p;
        struct profile_state st;
        double jerk, largest = 0, fastest = 0, speed = 0, change = 0;

        t.speed = decades(0.01, 100);
        t.acceleration = t.speed / decades(20, 3000);
        t.jerk_ticks = decades(2, 400);
        t.target_q32 = t.start.position_q32 +
                       llround(decades(1, t.speed * 5000 + 2)) * (INT64_C(1) << 32);
        jerk = t.acceleration / t.jerk_ticks;
        plan(&p, &t);
        profile_begin(&st, &p);
        while (profile_moving(&st)) {
            int64_t from = st.position_q32;
            double step, changed;

            profile_tick(&st);
            step = (double)(st.position_q32 - from) / ONE;
            changed = step - speed;
            largest = fmax(largest, fabs(changed - change));
            fastest = fmax(fastest, step);
            CHECK(step >= -1e-6 && step <= t.speed + 1e-6);
            CHECK(fabs(changed) <= t.acceleration + 1e-6);
            speed = step;
            change = changed;
        }
        CHECK(largest <= jerk + 1e-6);
        CHECK(st.position_q32 == t.target_q32);
        /* And it uses it: not a gentler motion than asked for. */
        if (t.jerk_ticks > 4 && fastest > 2 * t.acceleration)
            CHECK(largest >= 0.9 * jerk - 1e-6);
    }
}

/* D / v + v / a + jerk time, where the speed is reached. */
TEST(a_jerk_costs_its_time_once)
{
    struct trial t = {.start = point(0, 0), .speed = 10, .acceleration = 0.1, .jerk_ticks = 30};
    struct profile_plan p;

    t.target_q32 = INT64_C(20000) << 32;
    plan(&p, &t);
    CHECK_INT(p.segment_count, 7);
    CHECK(fabs((double)profile_ticks(&p) - (20000 / 10 + 10 / 0.1 + 30)) <= 1);
}

TEST(replans_a_moving_axis_under_a_jerk)
{
    srand(10);
    for (int i = 0; i < 500; i++) {
        struct trial t = random_trial(true);
        struct profile_plan p;
        struct profile_state st;
        double before = fabs(velocity(&t.start)), limit;

        t.jerk_ticks = decades(1, 300);
        limit = fmax(before, t.speed);
        plan(&p, &t);
        profile_begin(&st, &p);
        CHECK(fabs((double)(profile_now(&st).position_q32 - t.start.position_q32)) < 1e-3 * ONE);
        while (profile_moving(&st)) {
            CHECK(fabs((double)st.step_q48 / ONE_Q48) <= limit * (1 + 1e-9) + t.acceleration);
            CHECK(fabs((double)st.change_q48 / ONE_Q48) <=
                  t.acceleration * (1 + 1 / t.jerk_ticks) + 1e-9);
            profile_tick(&st);
        }
        CHECK(st.position_q32 == t.target_q32);
    }
}

/* Longer than 2^32 ticks, the counter of the interrupt: 1 nm in 6 days at 10 kHz. */
TEST(lasts_as_long_as_it_takes)
{
    struct trial t = {.start = point(0, 0), .speed = 1e-9, .acceleration = 1e-9};
    struct profile_plan p;
    struct profile_state st;

    t.target_q32 = INT64_C(5) << 32;
    plan(&p, &t);
    CHECK(profile_ticks(&p) > UINT64_C(5000000000));
    profile_begin(&st, &p);
    profile_tick(&st);
    profile_tick(&st);
    CHECK_INT(st.ticks_left_high, 1);
    st.ticks_left = 1;
    profile_tick(&st);
    CHECK(profile_moving(&st));
    st.ticks_left = 1;
    profile_tick(&st);
    CHECK(st.index == 2 || !profile_moving(&st));
}

TEST(stays_in_range_at_the_ends_of_the_counts)
{
    struct trial t = {.start = point(-1073741824.0, 0), .speed = 256, .acceleration = 1};
    struct profile_plan p;

    t.target_q32 = ((INT64_C(1) << 30) - 1) * (INT64_C(1) << 32);
    plan(&p, &t);
    CHECK(fabs((double)profile_ticks(&p) - (2147483648.0 / 256 + 256)) <= 1);
    CHECK(profile_at(&p, profile_ticks(&p)).position_q32 == t.target_q32);
    CHECK(profile_at(&p, profile_ticks(&p) - 1).position_q32 <= t.target_q32);
}

TEST(goes_nowhere_in_no_time)
{
    struct trial t = {.start = point(5, 0), .speed = 1, .acceleration = 1};
    struct profile_plan p;
    struct profile_state st;

    t.target_q32 = INT64_C(5) << 32;
    plan(&p, &t);
    CHECK_INT(profile_ticks(&p), 0);
    profile_rest(&st, t.target_q32);
    profile_begin(&st, &p);
    CHECK(!profile_moving(&st));
}

TEST_MAIN(RUN(ends_on_its_target_at_rest);
          RUN(begins_where_it_was_planned_from);
          RUN(keeps_speed_and_acceleration);
          RUN(takes_no_longer_than_a_trapezoid);
          RUN(is_at_each_tick_where_the_laws_of_motion_have_it);
          RUN(cruises_at_exactly_the_speed_asked_for);
          RUN(has_no_slowest_speed);
          RUN(a_speed_that_is_none_lasts_for_ever);
          RUN(is_predicted_to_the_thousandth_of_a_count);
          RUN(replaces_a_motion_without_a_jump);
          RUN(stops_on_a_whole_count_within_the_acceleration);
          RUN(keeps_its_jerk);
          RUN(a_jerk_costs_its_time_once);
          RUN(replans_a_moving_axis_under_a_jerk);
          RUN(lasts_as_long_as_it_takes);
          RUN(stays_in_range_at_the_ends_of_the_counts);
          RUN(goes_nowhere_in_no_time))
