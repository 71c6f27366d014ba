/* SPDX-License-Identifier: BSD-2-Clause */
/* AZERO on the board: what is measured, what the gains are good for, what ends it. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "closed_loop.h"
#include "core/fault.h"
#include "modules/axis.h"
#include "modules/motion.h"
#include "modules/screw.h"
#include "modules/tuning.h"

#define DONE ":A \r\n"
#define FAILED ":N-5\r\n"
#define SEND(line) CHECK_TEXT(closed_loop_send(line), DONE)
#define TUNE(line) CHECK_TEXT(closed_loop_ask(line, 5000), DONE)

static const double TICK_MS = CLOSED_LOOP_TICK_US / 1000.0;

/* Of plant.toml: full drive less friction moves 7.48 mm/s, friction is a tenth of full drive, 2500
 * steps. */
static const double drive_per_speed = 2500 / (7.48 / 0.9 * 45.396), time_constant_ms = 7,
                    friction_steps = 250;

static void start(const struct closed_loop_change *changes)
{
    closed_loop_start(changes);
    fault_clear();
}

static bool is_near(double value, double expected, double share)
{
    return fabs(value - expected) <= share * fabs(expected);
}

static bool same_gains(const struct pid_gains *a, const struct pid_gains *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* The gains of an axis with a motor as far from the default as these say. */
#define CHECK_FOUND(speed, time, friction)                                                         \
    do {                                                                                           \
        const struct pid_gains found = tuning_gains(0);                                            \
        const double kv = 16 * drive_per_speed / (speed);                                          \
                                                                                                   \
        if (!is_near(found.kv, kv, 0.02) ||                                                        \
            !is_near(found.ka, kv / 8 * time_constant_ms * (time), 0.03) ||                        \
            !is_near(found.friction_steps, friction_steps * (friction), 0.04))                     \
            CHECK_FAIL("KV %d KADC %d KF %d", found.kv, found.ka, found.friction_steps);           \
    } while (0)

TEST(the_gains_are_those_of_the_motor)
{
    static const struct {
        const char *name, *other;
        double factor, speed, time, friction;
    } motors[] = {
        {NULL, NULL, 1, 1, 1, 1},
        {"x.mechanical_time_constant_ms", NULL, 0.7, 1, 0.7, 1},
        {"x.mechanical_time_constant_ms", NULL, 1.3, 1, 1.3, 1},
        {"x.mechanical_time_constant_ms", NULL, 3, 1, 3, 1},
        {"x.speed_scale", NULL, 0.6, 0.6, 1, 1},
        {"x.counts_per_mm", NULL, 0.25, 0.25, 1, 1},
        {"x.breakaway_friction", NULL, 1.6, 1, 1, 1},
    };

    for (unsigned n = 0; n < sizeof motors / sizeof *motors; n++) {
        const struct closed_loop_change changes[] = {{motors[n].name, motors[n].factor}, {NULL, 0}};

        start(changes);
        TUNE("AZ X");
        CHECK_FOUND(motors[n].speed, motors[n].time, motors[n].friction);
    }
}

/* Friction is part of full drive's speed in plant.toml: less of it is a slower motor there. */
TEST(friction_is_measured)
{
    static const double factors[] = {0.5, 1.4};

    for (unsigned n = 0; n < 2; n++) {
        const struct closed_loop_change changes[] = {{"x.running_friction", factors[n]},
                                                     {NULL, 0}};

        start(changes);
        TUNE("AZ X");
        CHECK_FOUND(0.9 / (1 - 0.1 * factors[n]), 1, factors[n]);
    }
}

/* The default gains are what AZ finds for the motor they were made for. */
TEST(the_default_gains_are_found_again)
{
    struct pid_gains before, found;

    start(NULL);
    before = tuning_gains(0);
    SEND("KP X=1 Y=1");
    SEND("KF X=1");
    TUNE("AZ X");
    found = tuning_gains(0);
    CHECK(is_near(found.kp, before.kp, 0.03) && is_near(found.ki, before.ki, 0.03));
    CHECK(is_near(found.kd, before.kd, 0.04) && is_near(found.kv, before.kv, 0.02));
    CHECK(is_near(found.ka, before.ka, 0.03));
    CHECK(is_near(found.friction_steps, before.friction_steps, 0.04));
    CHECK_INT(tuning_gains(1).kp, 1);
}

/* Send a move; ms until it is done, or -1. `error` is how far off the true position is then. */
static double move(double mm, double counts_per_mm, double *error)
{
    char line[40];
    int ticks;

    snprintf(line, sizeof line, "M X=%.3f", mm * 1e4);
    if (strcmp(closed_loop_send(line), DONE) != 0 || (ticks = closed_loop_wait(50000)) < 0)
        return -1;
    *error = fabs(closed_loop_position(0) - floor(mm * counts_per_mm + 0.5) - 0.5);
    return ticks * TICK_MS;
}

/* The figures of tb/bench with gains that were wrong and have been found. */
static const struct {
    double pitch_mm, far_ms, near_ms;
} screws[] = {{1.5875, 5360, 150}, {6.35, 1400, 55}, {12.7, 730, 40}, {25.4, 400, 32}};

TEST(moves_are_fast_and_exact_on_every_screw)
{
    for (unsigned n = 0; n < 4; n++) {
        const struct screw *screw = screw_of_pitch(screws[n].pitch_mm);
        const double resolution = screw->resolution_mm * screw->counts_per_mm + 1;
        const struct closed_loop_change changes[] = {
            {"x.pitch_mm", screw->pitch_mm / 6.35},
            {"x.counts_per_mm", screw->counts_per_mm / 45396},
            {"x.maximum_speed_mm_per_s", screw->speed_max_mm_per_s / 6.8},
            {"x.mechanical_time_constant_ms", 1.3}, {NULL, 0}};
        char line[40];
        double error = 1e9;

        start(changes);
        snprintf(line, sizeof line, "SCREW X=%.4f", screw->pitch_mm);
        SEND(line);
        SEND("KP X=60");
        SEND("KD X=10");
        SEND("KI X=1");
        SEND("KV X=5");
        SEND("KA X=5");
        SEND("KF X=5");
        SEND("AC X=16");
        SEND("S X=1000");
        snprintf(line, sizeof line, "PC X=%.6f", screw->resolution_mm);
        SEND(line);
        TUNE("AZ X");
        CHECK(move(9, screw->counts_per_mm, &error) > 0);
        CHECK(error <= resolution);
        double near_ms = move(9.2, screw->counts_per_mm, &error);

        CHECK(near_ms > 0 && near_ms <= screws[n].near_ms && error <= resolution);
        double far_ms = move(0.2, screw->counts_per_mm, &error);

        CHECK(far_ms > 0 && far_ms <= screws[n].far_ms && error <= resolution);
    }
}

TEST(it_answers_at_its_end_and_stands_where_it_began)
{
    start(NULL);
    SEND("M X=1000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_TEXT(closed_loop_ask("AZ X", 1000), ""); /* 0.2 s */
    CHECK(motion_axis_busy(0) && !motion_axis_busy(1));
    /* A client waits a second for it. */
    CHECK_TEXT(closed_loop_ask("", 1000), DONE);
    CHECK(!motion_busy());
    CHECK_INT(board_count(closed_loop_board(), 0), 4540);
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    SEND("R X=10");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 4585);
}

TEST(axes_are_measured_one_after_the_other)
{
    const struct closed_loop_change changes[] = {{"y.mechanical_time_constant_ms", 1.3}, {NULL, 0}};

    start(changes);
    SEND("KV X=20 Y=20 Z=20");
    TUNE("AZ Y X");
    CHECK_FOUND(1, 1, 1);
    CHECK(is_near(tuning_gains(1).ka, 93 * 1.3, 0.04));
    CHECK_INT(tuning_gains(2).kv, 20);
}

/* At any time on the way. */
TEST(a_halt_ends_it_with_the_gains_as_they_were)
{
    for (unsigned when = 10;; when += 50) {
        struct pid_gains before;
        const char *reply;

        start(NULL);
        SEND("KP X=700");
        before = tuning_gains(0);
        (void)closed_loop_ask("AZ X", (int)when);
        if (!motion_busy()) {
            CHECK(when > 1000); /* two tenths of a second */
            break;
        }
        reply = closed_loop_ask("\\", 10);
        CHECK_TEXT(reply, FAILED);
        CHECK_TEXT(closed_loop_ask("", 10), ":N-21\r\n");
        const struct pid_gains after = tuning_gains(0);

        CHECK(same_gains(&after, &before));
        CHECK_TEXT(closed_loop_send("/"), "N\r\n");
        closed_loop_run(500);
        CHECK(motion_in_position(0));
        SEND("M X=0");
        CHECK(closed_loop_wait(5000) > 0);
        CHECK_INT(board_count(closed_loop_board(), 0), 0);
    }
}

/* An owner that does not give an axis away, as a scan. */
static bool refuse(unsigned axis, const struct motion_owner *to)
{
    (void)axis;
    (void)to;
    return false;
}

TEST(it_is_refused_where_nothing_may_move)
{
    static const struct motion_owner other = {.name = "other", .letter = 'A', .yield = refuse};

    start(NULL);
    CHECK_TEXT(closed_loop_send("AZ"), ":N-3\r\n");
    CHECK_TEXT(closed_loop_send("AZ Q"), ":N-2\r\n");
    CHECK_TEXT(closed_loop_send("AZ X?"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("AZ X=1"), ":N-4\r\n");
    SEND("MC Y-");
    CHECK_TEXT(closed_loop_send("AZ X Y"), FAILED);
    SEND("MC Y+");
    closed_loop_run(200);
    SEND("M Y=1000");
    CHECK_TEXT(closed_loop_send("AZ X Y"), FAILED);
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 1), 4540);
    CHECK(motion_claim(MOTION_AXIS(1), &other));
    CHECK_TEXT(closed_loop_send("AZ X Y"), FAILED);
    motion_release(MOTION_AXIS(1), &other);
    board_set_input(closed_loop_board(), BOARD_ESTOP, 1);
    closed_loop_run(50);
    CHECK_TEXT(closed_loop_send("AZ X"), FAILED);
    board_set_input(closed_loop_board(), BOARD_ESTOP, 0);
    closed_loop_run(200);
    SEND("SL X=-0.3");
    SEND("SU X=0.3");
    CHECK_TEXT(closed_loop_send("AZ X"), FAILED);
    closed_loop_run(500);
    CHECK_INT(board_count(closed_loop_board(), 0), 0);
    CHECK_INT(fault_read(0), FAULT_NONE);
}

/* As right after power-up and RESET: 10 ms of standing still come first. */
TEST(it_waits_for_an_axis_that_is_about_to_be_regulated)
{
    struct axis_view view;

    start(NULL);
    SEND("KV X=20 Y=20");
    SEND("MC X-");
    closed_loop_run(10);
    SEND("MC X+");
    axis_read(0, &view);
    CHECK_INT(view.mode, LOOP_FREE);
    TUNE("AZ X Y");
    CHECK_FOUND(1, 1, 1);
    CHECK(is_near(tuning_gains(1).kv, tuning_gains(0).kv, 0.02));
    CHECK_INT(board_count(closed_loop_board(), 0), 0);
}

TEST(the_emergency_stop_ends_it)
{
    struct pid_gains before, after;

    start(NULL);
    SEND("KV X=20");
    before = tuning_gains(0);
    CHECK_TEXT(closed_loop_ask("AZ X", 200), "");
    board_set_input(closed_loop_board(), BOARD_ESTOP, 1);
    CHECK_TEXT(closed_loop_ask("", 50), FAILED);
    after = tuning_gains(0);
    CHECK(same_gains(&after, &before));
    CHECK(!motion_busy());
}

/* It goes where there is room, and stays within what it was given. */
TEST(limits_are_kept)
{
    double lowest = 0, highest = 0;

    start(NULL);
    SEND("SL X=-5");
    SEND("SU X=0.05");
    (void)closed_loop_ask("AZ X", 1);
    for (int n = 0; n < 5000 && motion_busy(); n++) {
        closed_loop_tick();
        lowest = fmin(lowest, closed_loop_position(0) / 45396);
        highest = fmax(highest, closed_loop_position(0) / 45396);
    }
    CHECK_TEXT(closed_loop_ask("", 10), DONE);
    CHECK(lowest < -0.2 && lowest > -1.02 && highest < 0.05);
}

/* A sluggish motor takes more way than was looked for. */
TEST(a_run_that_gets_to_a_limit_ends)
{
    const struct closed_loop_change changes[] = {{"x.mechanical_time_constant_ms", 5}, {NULL, 0}};

    start(changes);
    SEND("SL X=-0.1");
    SEND("SU X=1.1");
    CHECK_TEXT(closed_loop_ask("AZ X", 5000), FAILED);
    closed_loop_run(500);
    CHECK(closed_loop_position(0) > 1.1 * 45396 && closed_loop_position(0) < 1.2 * 45396);
}

TEST(a_limit_switch_refuses_it_and_ends_it)
{
    struct pid_gains before, after;

    start(NULL);
    before = tuning_gains(0);
    SEND("S X=6.8");
    SEND("M X=600000");
    CHECK(closed_loop_wait(60000) > 0);
    closed_loop_run(500);
    CHECK_TEXT(closed_loop_send("AZ X"), FAILED);
    SEND("R X=-4000"); /* 0.2 mm below the switch */
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_TEXT(closed_loop_ask("AZ X", 2000), FAILED);
    CHECK_INT(fault_read(0), FAULT_LIMIT_UPPER);
    CHECK(closed_loop_position(0) < 55.3 * 45396);
    after = tuning_gains(0);
    CHECK(same_gains(&after, &before));
}

TEST(a_cut_motor_wire_is_a_dead_axis)
{
    struct pid_gains before, after;

    start(NULL);
    before = tuning_gains(0);
    board_cut_pwm(closed_loop_board(), 1);
    CHECK_TEXT(closed_loop_ask("AZ X", 1000), FAILED);
    CHECK_INT(fault_read(0), FAULT_AXIS_DEAD + 0);
    after = tuning_gains(0);
    CHECK(same_gains(&after, &before));
    board_cut_pwm(closed_loop_board(), 0);
}

TEST(a_reversed_motor_is_found_out)
{
    start(NULL);
    closed_loop_reverse(0, true);
    CHECK_TEXT(closed_loop_ask("AZ X", 1000), FAILED);
    CHECK_INT(fault_read(0), FAULT_RUNAWAY + 0);
    closed_loop_run(500);
    CHECK(closed_loop_position(0) > -0.5 * 45396);
    closed_loop_reverse(0, false);
}

/* A hand that pushes half as hard as the drive: the two ways differ too much for a motor alone. */
TEST(an_obstacle_on_one_way_is_found_out)
{
    struct pid_gains before, after;

    start(NULL);
    before = tuning_gains(0);
    (void)closed_loop_ask("AZ X", 1);
    for (int n = 0; n < 5000 && motion_busy(); n++) {
        /* Thicker as it goes: half of the speed is lost. */
        struct axis_view view;

        closed_loop_tick();
        axis_read(0, &view);
        closed_loop_push(0, view.mode == LOOP_SPIN && view.duty_steps < 0
                                ? -0.5 * view.duty_steps / 2500.0 : 0);
    }
    closed_loop_push(0, 0);
    CHECK_TEXT(closed_loop_ask("", 10), FAILED);
    after = tuning_gains(0);
    CHECK(same_gains(&after, &before));
}

/* A weight helps one way and hinders the other. */
TEST(a_weight_does_not_disturb)
{
    start(NULL);
    SEND("KV X=20");
    closed_loop_push(0, -0.05);
    TUNE("AZ X");
    closed_loop_push(0, 0);
    CHECK_FOUND(1, 1, 1);
}

TEST_MAIN(RUN(the_gains_are_those_of_the_motor); RUN(friction_is_measured);
          RUN(the_default_gains_are_found_again); RUN(moves_are_fast_and_exact_on_every_screw);
          RUN(it_answers_at_its_end_and_stands_where_it_began);
          RUN(axes_are_measured_one_after_the_other);
          RUN(a_halt_ends_it_with_the_gains_as_they_were);
          RUN(it_is_refused_where_nothing_may_move);
          RUN(it_waits_for_an_axis_that_is_about_to_be_regulated); RUN(the_emergency_stop_ends_it);
          RUN(limits_are_kept); RUN(a_run_that_gets_to_a_limit_ends);
          RUN(a_limit_switch_refuses_it_and_ends_it);
          RUN(a_cut_motor_wire_is_a_dead_axis); RUN(a_reversed_motor_is_found_out);
          RUN(an_obstacle_on_one_way_is_found_out); RUN(a_weight_does_not_disturb))
