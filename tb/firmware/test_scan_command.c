/* SPDX-License-Identifier: BSD-2-Clause */
/* The SCAN commands: replies, refusals, stops, errors, settings. */
#include "scan_check.h"

#include <math.h>
#include <stdlib.h>

#include "core/action.h"
#include "hal/compare.h"
#include "modules/axis.h"

TEST(impossible_scans_are_refused_and_move_nothing)
{
    static const char *const settings[] = {
        "SCANR X=1 Y=1",           /* start is stop */
        "SCANR Y=0.0001",          /* shorter than a pixel */
        "SCANR Z=50000",           /* the same */
        "SCAN X=0 Y=0 Z=0",        /* no axis */
        "SCANR T=78",              /* pulses would merge: a pixel lasts 77.7 us at full speed */
        "SCANR Y=120",             /* beyond the soft limit at 110 mm */
        "SCANV X=111",             /* the same, slow axis */
        "SCANR X=-109.99 Y=-109",  /* the line fits, its run-up does not */
        "SCANR X=30000 Y=30001",   /* beyond the counts */
    };

    for (size_t n = 0; n < sizeof settings / sizeof settings[0]; n++) {
        stage_start();
        WORKED_EXAMPLE;
        SEND(settings[n], ACKNOWLEDGED);
        SEND("SCAN", ":N-4\r\n");
        SEND("SCAN X=83", ":N-4\r\n");
        SEND("SCAN S", ":N-4\r\n");
        SEND("/", "N\r\n");
        SEND("SCAN X?", ":A I\r\n");
        CHECK(!moved());
        CHECK_INT(fault_read(0), FAULT_NONE);
    }
    /* And the next good one works. */
    SEND("SCANR X=0 Y=1", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK(stage_run(200000) > 0);
    CHECK(pixels_lie_on(&stage_lines[0], 1891, 24000));
}

TEST(a_start_that_is_refused_leaves_the_rest_of_its_line_undone)
{
    stage_start();
    SEND("SCAN X=83 F=1", ":N-4\r\n"); /* start is stop after power-up */
    SEND("SCAN F?", ":A 0\r\n");
    WORKED_EXAMPLE;
    SEND("SCAN S R=9 T=3", ":N-4\r\n");
    SEND("SCAN R? T?", ":A 1 0\r\n");
    SEND("SCAN S R=2 T=9", ACKNOWLEDGED);
    SEND("SCAN R? T?", ":A 9 2\r\n");
}

TEST(disabled_axis_cannot_scan)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("MC X-", ACKNOWLEDGED);
    SEND("SCAN", ":N-5\r\n");
    CHECK(!moved());
}

TEST(settings_are_refused_out_of_range)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANR Z=0", ":N-4\r\n");
    SEND("SCANR Z=0.9", ":N-4\r\n");
    SEND("SCANR Z=-24", ":N-4\r\n");
    SEND("SCANR R=0", ":N-4\r\n");
    SEND("SCANR R=101", ":N-4\r\n");
    SEND("SCANR T=0.001", ":N-4\r\n");
    SEND("SCANV Z=0", ":N-4\r\n");
    SEND("SCANV F=-1", ":N-4\r\n");
    SEND("SCAN F=2", ":N-4\r\n");
    SEND("SCAN X=3", ":N-4\r\n");
    SEND("SCAN X=1 Y=1", ":N-4\r\n");
    SEND("SCAN Y=9 Z=7", ":N-4\r\n");
    SEND("SCAN Y=1 Z=1", ":N-4\r\n");
    SEND("SCANR Q=1", ":N-2\r\n");
    SEND("SCAN Q=1", ":N-2\r\n");
    SEND("SCANR", ":N-3\r\n");
    SEND("SCANV", ":N-3\r\n");
    SEND("SCANR X=", ":N-3\r\n");
    SEND("SCANF =0", ":N-1\r\n");
    SEND("SCANR X=5 Z=0", ":N-4\r\n"); /* all or nothing */
    SEND("SCANR X? Y? Z?", ":A X=0.000000 Y=1.000000 Z=24\r\n");
}

TEST(queries_answer_in_their_forms)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SN X?", ":A I\r\n");
    SEND("SN F?", ":A 0\r\n");
    SEND("SN Y?", ":A 2\r\n");
    SEND("SN X? Y? Z?", ":A I 2 0\r\n");
    SEND("SN F? X?", ":A I 0\r\n");
    SEND("SN T? R? Z? F? X?", ":A I 0 0 1 0\r\n");
    SEND("NR X?", ":A X=0.000000\r\n");
    SEND("NR Z?", ":A Z=24\r\n");
    SEND("NR F?", ":A F=1891\r\n");
    SEND("NR R? T? M?", ":A T=0.000000 R=67.000000 M=0\r\n");
    SEND("NV X? Y? Z? F? T?", ":A X=0.000000 Y=1.000000 Z=1 F=10 T=0.000000\r\n");
    SEND("NV R? M?", ":A R=0 M=0\r\n");
    SEND("scanr z=24.4", ACKNOWLEDGED);
    SEND("NR Z?", ":A Z=24.4\r\n");
    SEND("SCANV X=1.234Y=1.234 Z=1.000000 F=2", ACKNOWLEDGED);
    SEND("NV X? Z? F?", ":A X=1.234000 Z=1 F=2\r\n");
}

TEST(number_of_pixels_and_stop_take_each_others_place)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("NR X=1 F=100", ACKNOWLEDGED);
    SEND("NR F?", ":A F=100\r\n");
    SEND("NR Y?", ":A Y=1.052868\r\n"); /* 1 + 2400 / 45396 */
    SEND("NR Y=2", ACKNOWLEDGED);
    SEND("NR Y? F?", ":A Y=2.000000 F=1891\r\n");
}

TEST(state_is_queried_while_it_scans)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    SEND("SCAN X?", ":A S\r\n");
    while (!stage_sync)
        stage_tick();
    stage_tick();
    SEND("SCAN X?", ":A e\r\n");
    SEND("RS X?", ":A B\r\n");
    SEND("RS X+", ":A B\r\n");
}

TEST(stop_ends_the_line_at_once_and_logs_nothing)
{
    static const char *const stops[] = {"SCAN X=80", "SCAN", "SCAN P"};

    for (size_t n = 0; n < sizeof stops / sizeof stops[0]; n++) {
        stage_start();
        WORKED_EXAMPLE;
        SEND("SCAN", ACKNOWLEDGED);
        go_into_the_line();
        CHECK(stage_sync);
        SEND(stops[n], ACKNOWLEDGED);
        CHECK(!stage_sync);
        CHECK_TEXT(states(), "PI");
        CHECK_INT(stage_line_count, 1);
        CHECK(!stage_lines[0].finished);
        CHECK(stage_position[0] < 1891 * 24);
        CHECK_INT(fault_read(0), FAULT_NONE);
        /* And again from the start. */
        SEND("SCAN", ACKNOWLEDGED);
        CHECK_TEXT(states(), "SabcdefI");
        CHECK(pixels_lie_on(&stage_lines[1], 1891, 24000));
    }
}

TEST(halt_ends_the_scan)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    go_into_the_line();
    SEND("HALT", ":N-21\r\n");
    CHECK(!stage_sync);
    CHECK_TEXT(states(), "PI");
    CHECK_INT(fault_read(0), FAULT_NONE);
    SEND("HALT", ACKNOWLEDGED);
    SEND("M X=0", ACKNOWLEDGED);
    CHECK(stage_run(200000) > 0);
    CHECK_INT(stage_position[0], 0);
}

TEST(start_and_stop_where_there_is_nothing_to_do)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN X=80", ACKNOWLEDGED);
    SEND("SCAN P", ACKNOWLEDGED);
    SEND("/", "N\r\n");
    SEND("SCAN X=83", ACKNOWLEDGED);
    go_into_the_line();
    SEND("SCAN X=83", ACKNOWLEDGED);
    CHECK(stage_sync);
    CHECK_TEXT(states(), "efI");
}

TEST(scan_keeps_its_axes_to_itself)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    go_into_the_line();
    SEND("M X=0", ":N-5\r\n");
    SEND("M Z=100", ACKNOWLEDGED);
    CHECK_TEXT(states(), "efI");
    CHECK(pixels_lie_on(&stage_lines[0], 1891, 24000));
    CHECK_INT(stage_position[2], 454); /* 10 um */
}

static void press(void)
{
    stage_estop = true;
}

static void halt(void)
{
    (void)port_send("\\");
}

static void ask(void)
{
    (void)port_send("SCAN X=80");
}

static void switch_fast_off(void)
{
    (void)port_send("MC X-");
}

static void switch_slow_off(void)
{
    (void)port_send("MC Y-");
}

/* Whatever ends it in whatever state, the pins are quiet, the axes free, and the next scan whole. */
TEST(every_end_in_every_state_leaves_nothing_behind)
{
    static void (*const ends[])(void) = {press, halt, ask, switch_fast_off, switch_slow_off};

    for (size_t n = 0; n < sizeof ends / sizeof ends[0]; n++) {
        for (const char *state = "Sabcdefgh"; *state != '\0'; state++) {
            int ticks = 0;

            stage_start();
            WORKED_EXAMPLE;
            SEND("SCANR Y=0.05", ACKNOWLEDGED);
            SEND("SCANV X=0.1 Y=0.4 Z=3", ACKNOWLEDGED);
            SEND("SCAN", ACKNOWLEDGED);
            while ((char)scan_run_state() != *state)
                stage_tick();
            ends[n]();
            while (scan_run_state() != SCAN_IDLE && ticks++ < 200)
                stage_tick();
            if (ticks > 150 || stage_sync || compare_status().armed || motion_busy())
                CHECK_FAIL("end %d in state %c: not over", (int)n, *state);

            stage_estop = false;
            SEND("MC X+ Y+", ACKNOWLEDGED);
            stage_line_count = 0;
            SEND("M X=0 Y=0", ACKNOWLEDGED);
            CHECK(stage_run(20000) > 0);
            SEND("SCAN", ACKNOWLEDGED);
            CHECK_TEXT(states(), "SabcdefghcdefghcdefI");
            CHECK_INT(stage_line_count, 3);
            for (unsigned line = 0; line < 3; line++)
                CHECK(pixels_lie_on(&stage_lines[line], 94, 24000));
            CHECK_INT(fault_read(0), FAULT_NONE);
        }
    }
}

TEST(emergency_stop_ends_the_scan)
{
    const char *seen;

    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    go_into_the_line();
    stage_estop = true;
    seen = states(); /* nothing is left to brake; but each axis takes notice at its own turn */
    if (strcmp(seen, "eI") != 0)
        CHECK_TEXT(seen, "eEI");
    CHECK(!stage_sync);
    SEND("/", "N\r\n");
}

TEST(a_scan_told_under_the_emergency_stop_does_not_start_when_it_is_released)
{
    stage_start();
    WORKED_EXAMPLE;
    stage_estop = true;
    stage_tick();
    SEND("SCAN", ":N-5\r\n");
    CHECK(!moved());
    SEND("/", "N\r\n");
    stage_estop = false;
    CHECK(!moved());
    SEND("SCAN X?", ":A I\r\n");
}

/* The axes have been switched on and are not regulated yet: their moves wait. */
TEST(an_emergency_stop_before_the_first_move_began_ends_the_scan)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("MC X- Y-", ACKNOWLEDGED);
    stage_tick();
    SEND("MC X+ Y+", ACKNOWLEDGED);
    stage_tick();
    SEND("SCAN", ACKNOWLEDGED);
    stage_tick();
    stage_estop = true;
    CHECK(!moved());
    SEND("/", "N\r\n");
    stage_estop = false;
    CHECK(!moved());
}

TEST(what_is_set_while_it_scans_is_for_the_next_scan)
{
    static const char *const changes[] = {
        "S X=6.8 Y=6.8", "AC X=1 Y=1", "C X=20000", "UM X=-10000", "H X=5000",
        "SCANR X=0.3 Y=0.7 Z=11", "SCANV Z=7 F=200", "TTL X=0",
    };

    for (size_t n = 0; n < sizeof changes / sizeof changes[0]; n++) {
        int ticks = 0;

        stage_start();
        WORKED_EXAMPLE;
        SEND("SCAN", ACKNOWLEDGED);
        SEND(changes[n], ACKNOWLEDGED);
        while (!stage_sync)
            stage_tick();
        for (; stage_sync; ticks++)
            stage_tick();
        CHECK_TEXT(states(), "fI");
        CHECK(pixels_lie_on(&stage_lines[0], 1891, 24000));
        CHECK(stage_lines[0].emit);
        /* 45384 counts at 2.112 mm/s. */
        if (ticks < 2366 || ticks > 2368)
            CHECK_FAIL("%s: %d ticks", changes[n], ticks);
        CHECK_INT(stage_position[0],
                  1891 * 24 + (int)ceil(2.112 * 0.035 * 45396) + 16);
    }
}

TEST(origin_moves_the_scan)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("H X=10000", ACKNOWLEDGED); /* count 0 is 1 mm */
    SEND("SCANR X=1 Y=2", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK(stage_run(200000) > 0);
    CHECK_INT(stage_lines[0].sync_edge, 0);
    CHECK(pixels_lie_on(&stage_lines[0], 1891, 24000));
}

TEST(both_dialects_name_axes)
{
    static const struct {
        const char *command, *fast, *slow;
    } cases[] = {
        {"SCAN X=2 Y=1 Z=0 F=0", "1", "0"}, {"SCAN X=1 Y=2", "0", "1"},
        {"SCAN X=1 Y=0 Z=0", "0", "9"},     {"SCAN X=0 Y=0 Z=0 F=0", "9", "9"},
        {"SCAN Z=2", "0", "2"},             {"SCAN Y=1", "1", "9"},
        {"SCAN Y=1 Z=0", "1", "0"},         {"SCAN Y=2 Z=1", "2", "1"},
        {"SCAN Y=1 Z=9", "1", "9"},         {"SCAN Z=9", "0", "9"},
        {"SCAN R=3 T=2", "3", "2"},
    };

    for (size_t n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        char expected[32];

        stage_start();
        SEND(cases[n].command, ACKNOWLEDGED);
        snprintf(expected, sizeof expected, ":A %s %s\r\n", cases[n].slow, cases[n].fast);
        SEND("SCAN R? T?", expected);
    }
    /* Without guessing. */
    stage_start();
    SEND("SCAN M=1", ACKNOWLEDGED);
    SEND("SCAN Y=1 Z=0", ACKNOWLEDGED);
    SEND("SCAN R? T?", ":A 9 1\r\n");
}

TEST(the_limits_of_the_original_can_be_had)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANR Z=7", ACKNOWLEDGED);
    SEND("SCAN C=1", ACKNOWLEDGED);
    SEND("SCAN C?", ":A 1\r\n");
    SEND("SCANR Z?", ":A Z=4\r\n");
    SEND("SCAN", ":N-4\r\n"); /* set before */
    SEND("SCANR Z=7.9", ":N-4\r\n");
    SEND("SCANR Z=11.9", ACKNOWLEDGED);
    SEND("SCANR Z?", ":A Z=8\r\n");
    SEND("SCANR Z=32768", ":N-4\r\n");
    SEND("SCANR Z=32767", ACKNOWLEDGED);
    SEND("SCANR Z?", ":A Z=32764\r\n");
    SEND("SCANR Z=38", ACKNOWLEDGED);
    SEND("SCANR Z? F?", ":A Z=36 F=1261\r\n"); /* 45396 / 36 */
    SEND("SCANR F=32768", ":N-4\r\n");
    SEND("SCANR Z=8", ACKNOWLEDGED);
    SEND("SCANR Y=5.78", ACKNOWLEDGED);
    SEND("SCAN", ":N-4\r\n"); /* 32798 pixels */
    CHECK(!moved());
    CHECK(!action_perform(ACTION_AT_LONG));
    SEND("SCANR Y=1 Z=26", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK(stage_run(200000) > 0);
    CHECK(pixels_lie_on(&stage_lines[0], 1891, 24000));
    SEND("SCAN C=0", ACKNOWLEDGED);
    SEND("SCANR Z?", ":A Z=26\r\n");
    SEND("SCAN C=2", ":N-4\r\n");
}

/* With JERK a change of speed takes longer; the way to it must be, too. */
TEST(the_line_is_at_constant_speed_whatever_the_ramp)
{
    static const char *const ramps[] = {"AC X=100", "AC X=20", "JERK X=30", "JERK X=0"};

    for (size_t n = 0; n < sizeof ramps / sizeof ramps[0]; n++) {
        struct axis_view view;

        stage_start();
        WORKED_EXAMPLE;
        SEND("SCANV F=1", ACKNOWLEDGED);
        SEND(ramps[n], ACKNOWLEDGED);
        SEND("SCAN", ACKNOWLEDGED);
        while (!stage_sync)
            stage_tick();
        const int64_t step_q32 = llround(2.112 * 45396 * AXIS_TICK_US * 1e-6 * 0x1p32);
        for (; stage_sync; stage_tick()) {
            axis_read(0, &view);
            if (view.ramping || llabs((view.setpoint.velocity_q48 >> 16) - step_q32) > 1)
                CHECK_FAIL("%s: at %d not at the speed of the line", ramps[n], stage_position[0]);
        }
        SEND("JERK X=0", ACKNOWLEDGED);
    }
}

TEST(settings_are_saved)
{
    stage_start();
    SEND("SCANR X=-1 Y=2 Z=24.4 R=50 T=2 M=1", ACKNOWLEDGED);
    SEND("SCANV X=3 Y=4 Z=5 F=6 T=0.7 R=1 M=2", ACKNOWLEDGED);
    SEND("SCAN X=2 Y=1 F=1 W=1", ACKNOWLEDGED);
    SEND("TTL X=1 Y=0 F=-1", ACKNOWLEDGED);
    SEND("SS Z", ACKNOWLEDGED);
    stage_start();
    SEND("NR X? Y? Z? F? T? R? M?",
         ":A X=-1.000000 Y=2.000000 Z=24.4 F=5581 T=2.000000 R=50.000000 M=1\r\n");
    SEND("NV X? Y? Z? F? T? R? M?",
         ":A X=3.000000 Y=4.000000 Z=5 F=6 T=0.700000 R=1 M=2\r\n");
    SEND("SN F? T? R? C? W?", ":A 1 0 1 0 1\r\n");
    SEND("TTL X? Y? F?", ":A X=1 Y=0 F=-1\r\n");
    SEND("NR F=7", ACKNOWLEDGED);
    SEND("SS Z", ACKNOWLEDGED);
    stage_start();
    SEND("NR F?", ":A F=7\r\n");
}

TEST_MAIN(RUN(impossible_scans_are_refused_and_move_nothing);
          RUN(a_start_that_is_refused_leaves_the_rest_of_its_line_undone);
          RUN(disabled_axis_cannot_scan); RUN(settings_are_refused_out_of_range);
          RUN(queries_answer_in_their_forms);
          RUN(number_of_pixels_and_stop_take_each_others_place);
          RUN(state_is_queried_while_it_scans); RUN(stop_ends_the_line_at_once_and_logs_nothing);
          RUN(halt_ends_the_scan); RUN(start_and_stop_where_there_is_nothing_to_do);
          RUN(scan_keeps_its_axes_to_itself);
          RUN(every_end_in_every_state_leaves_nothing_behind);
          RUN(emergency_stop_ends_the_scan);
          RUN(a_scan_told_under_the_emergency_stop_does_not_start_when_it_is_released);
          RUN(an_emergency_stop_before_the_first_move_began_ends_the_scan);
          RUN(what_is_set_while_it_scans_is_for_the_next_scan); RUN(origin_moves_the_scan);
          RUN(both_dialects_name_axes); RUN(the_limits_of_the_original_can_be_had);
          RUN(the_line_is_at_constant_speed_whatever_the_ramp); RUN(settings_are_saved))
