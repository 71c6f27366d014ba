/* SPDX-License-Identifier: BSD-2-Clause */
/* Steps that a trigger starts are planned before it comes: the servo tick that sees IN0 risen begins them. */
#include "check.h"

#include <math.h>

#include "core/action.h"
#include "core/events.h"
#include "core/fault.h"
#include "machine.h"
#include "modules/motion.h"
#include "panel.h"
#include "port.h"
#include "regs.h"
#include "rig.h"

#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)
#define DONE ":A \r\n"

enum { X, Y, Z };

static void start(void)
{
    machine_start();
    panel_start();
    machine_run(200);
}

static void edge(void)
{
    panel_ttl(INPUTS_IN0, true, 0);
    panel_ttl(INPUTS_IN0, false, 0);
}

TEST(the_tick_that_sees_the_edge_drives)
{
    static const struct {
        const char *set_up[4], *mode;
        char axis;
        double steps[3];
    } cases[] = {
        {{"R X=0 Z=20", NULL}, "TTL X=2", 'Z', {40, 60, 80}},
        {{"ZS X=100 Y=5 F=0", NULL}, "TTL X=4", 'Z', {-200, -100, 0}},
        {{"LD X=100", "LD X=300", NULL}, "TTL X=1", 'X', {100, 300, 100}},
        {{"LD X=100", "LD X=300", NULL}, "TTL X=12", 'X', {100, 400, 500}},
    };

    for (size_t n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        const unsigned axis = cases[n].axis == 'X' ? X : Z;

        start();
        for (unsigned line = 0; cases[n].set_up[line] != NULL; line++)
            (void)machine_send(cases[n].set_up[line]);
        SEND(cases[n].mode, DONE);
        for (unsigned step = 0; step < 3; step++) {
            CHECK(machine_wait());
            machine_run(500);
            CHECK(motion_is_prepared());
            CHECK_INT(pwm_duty_read(axis), 0);
            CHECK_TEXT(port_send("/"), "N\r\n");
            machine_run(1); /* past the doubt that the line brings */
            edge();
            axis_tick();
            CHECK(pwm_duty_read(axis) != 0);
            CHECK_TEXT(port_send("/"), "B\r\n");
            CHECK_TARGET(cases[n].axis, cases[n].steps[step]);
        }
        CHECK(machine_wait());
        CHECK_INT(fault_read(0), FAULT_NONE);
    }
}

TEST(an_edge_that_the_main_loop_takes_before_a_tick_counts_in_the_next_tick)
{
    start();
    SEND("R Z=20", DONE);
    SEND("TTL X=2", DONE);
    CHECK(machine_wait());
    machine_run(500);
    edge();
    rig_turn();
    axis_tick();
    CHECK(pwm_duty_read(Z) != 0);
    machine_run(10);
    CHECK_TARGET('Z', 40);
    CHECK(machine_wait());
    machine_run(100);
    CHECK_TARGET('Z', 40);
}

TEST(bare_rm_takes_the_plan_that_is_there)
{
    start();
    SEND("R Z=20", DONE);
    SEND("TTL X=2", DONE);
    CHECK(machine_wait());
    machine_run(500);
    CHECK(motion_is_prepared());
    SEND("RM", DONE);
    CHECK(!motion_is_prepared());
    CHECK_TEXT(port_send("/"), "B\r\n");
    CHECK_TARGET('Z', 40);
    CHECK(machine_wait());
    CHECK_TARGET('Z', 40);
}

TEST(a_line_puts_the_plan_in_doubt_until_it_is_looked_at_again)
{
    start();
    SEND("R Z=20", DONE);
    SEND("TTL X=2", DONE);
    CHECK(machine_wait());
    machine_run(500);
    CHECK(motion_is_prepared());
    CHECK_TEXT(port_send("ZS X=50"), DONE); /* the console alone: the modules have had no turn */
    edge();
    axis_tick();
    CHECK_INT(pwm_duty_read(Z), 0);
    machine_run(1);
    CHECK_TARGET('Z', 70);
    CHECK(machine_wait());
    machine_run(500);
    (void)port_send("W Z"); /* lines that only ask put nothing in doubt */
    (void)port_send("/");
    (void)port_send("S Z? X?");
    edge();
    axis_tick();
    CHECK(pwm_duty_read(Z) != 0);
    CHECK_TARGET('Z', 120);
}

TEST(an_axis_that_still_settles_begins_too)
{
    unsigned settling = 0;

    start();
    SEND("R Z=20", DONE);
    SEND("TTL X=2", DONE);
    for (unsigned n = 0; n < 3000 && settling < 4; n++) {
        machine_run(1);
        settling = motion_stands(Z) && !motion_in_position(Z) ? settling + 1 : 0;
    }
    CHECK_INT(settling, 4);
    CHECK(motion_is_prepared());
    edge();
    axis_tick();
    machine_run(1);
    CHECK_TARGET('Z', 40);
    CHECK(!motion_stands(Z));
}

TEST(settings_that_make_another_plan_make_it)
{
    static const char *const changes[] = {"S Z=0.3", "AC Z=33", "JERK Z=20", "B Z=0.002",
                                          "UM Z=-10000", "C Z=20000", "ZS X=50"};

    for (size_t n = 0; n < sizeof changes / sizeof changes[0]; n++) {
        int32_t duty;

        start();
        SEND("R Z=20", DONE);
        SEND("TTL X=2", DONE);
        CHECK(machine_wait());
        machine_run(500);
        (void)machine_send(changes[n]);
        machine_run(2);
        CHECK(motion_is_prepared());
        edge();
        axis_tick();
        duty = pwm_duty_read(Z);
        /* The same as of a plan that is made when the trigger comes. */
        start();
        SEND("R Z=20", DONE);
        CHECK(machine_wait());
        (void)machine_send(changes[n]);
        SEND("TTL X=2", DONE);
        machine_run(500);
        edge();
        axis_tick();
        if (duty == 0 || duty != pwm_duty_read(Z))
            CHECK_FAIL("%s: %d, not %d", changes[n], (int)duty, (int)pwm_duty_read(Z));
        SEND("JERK Z=0", DONE);
    }
}

/* An axis that does not stand where it was planned from keeps all of them back, and the step is planned anew. */
TEST(all_axes_of_a_step_begin_or_none)
{
    start();
    SEND("LD X=100 Y=200", DONE);
    SEND("TTL X=1", DONE);
    machine_run(500);
    CHECK(motion_is_prepared());
    axis_spin(Y, 100);
    for (unsigned n = 0; n < 5; n++)
        axis_tick();
    axis_spin(Y, 0);
    for (unsigned n = 0; n < 5; n++)
        axis_tick();
    edge();
    axis_tick();
    CHECK_INT(pwm_duty_read(X), 0);
    machine_run(500);
    CHECK_TARGET('X', 100);
    CHECK_TARGET('Y', 200);
    CHECK(machine_wait());
    SEND("RM Z?", ":A Z=0\r\n");
}

TEST(what_is_prepared_gives_way_to_any_other_motion)
{
    static const char *const lines[] = {"M Z=500", "M X=500", "\\", "MC Z-", "VE X=0.1"};

    for (size_t n = 0; n < sizeof lines / sizeof lines[0]; n++) {
        start();
        SEND("R Z=20", DONE);
        SEND("TTL X=2", DONE);
        CHECK(machine_wait());
        machine_run(500);
        CHECK(motion_is_prepared());
        (void)port_send(lines[n]);
        if (motion_is_prepared())
            CHECK_FAIL("%s", lines[n]);
    }
}

TEST(a_step_beyond_a_limit_is_clipped_and_logged_as_any_move)
{
    start();
    SEND("SU Z=0.003", DONE);
    SEND("R Z=20", DONE);
    SEND("TTL X=2", DONE);
    CHECK(machine_wait());
    machine_run(500);
    CHECK(!motion_is_prepared());
    edge();
    machine_run(2);
    CHECK_TARGET('Z', 30);
    CHECK(fault_read(0) != FAULT_NONE);
    SEND("SU Z=110", DONE);
}

TEST(edges_before_the_start_are_not_heard_and_later_ones_are)
{
    machine_start();
    panel_start();
    SEND("TTL X=10 Y=0", DONE);
    SEND("SS Z", ":A \r\n");
    edge();
    rig_start(); /* as after power-up, with these settings and an edge that nobody has taken */
    machine_run(20);
    SEND("TTL", ":A 0\r\n");
    edge();
    machine_run(1);
    SEND("TTL", ":A 1\r\n");
    SEND("TTL X=0 Y=1", DONE);
    SEND("SS Z", ":A \r\n");
}

/* --- Going by itself --------------------------------------------------------------------------- */

static void load_three(void)
{
    SEND("RM X=0", DONE);
    SEND("LD X=100", DONE);
    SEND("LD X=200", DONE);
    SEND("LD X=300", DONE);
    SEND("RT Z=1000", DONE);
}

TEST(it_is_busy_from_the_first_point_to_the_last)
{
    start();
    load_three();
    SEND("RM F=2", DONE);
    SEND("TTL X=1", DONE);
    machine_run(50);
    edge();
    for (unsigned ms = 0; ms < 2010; ms++) {
        machine_run(5);
        if (strcmp(port_send("/"), "B\r\n") != 0)
            CHECK_FAIL("after %u ms", ms);
    }
    CHECK(machine_wait());
    CHECK_TARGET('X', 300);
    SEND("RM F?", ":A F=2\r\n");
}

TEST(each_point_gives_a_pulse)
{
    unsigned pulses = 0;
    bool before = false;

    start();
    load_three();
    SEND("TTL X=1 Y=2", DONE);
    SEND("RT Y=20", DONE);
    SEND("RM F=2", DONE);
    machine_run(50);
    edge();
    for (unsigned n = 0; n < 15000; n++) {
        machine_run(1);
        const bool now = strcmp(port_send("TTL"), ":A 1\r\n") == 0;
        pulses += now && !before;
        before = now;
    }
    CHECK_INT(pulses, 3);
}

TEST(a_move_or_a_halt_between_points_ends_it)
{
    static const char *const lines[] = {"M X=1000", "\\", "RM F=3", "RM X=0", "RM"};

    for (size_t n = 0; n < sizeof lines / sizeof lines[0]; n++) {
        start();
        load_three();
        SEND("RM F=3", DONE);
        SEND("TTL X=1", DONE);
        machine_run(50);
        edge();
        machine_run(4000); /* 0.8 s: at the first point */
        CHECK_TEXT(port_send("/"), "B\r\n");
        (void)machine_send(lines[n]);
        CHECK(machine_wait());
        machine_run(10000);
        SEND("RM F?", ":A F=3\r\n");
        CHECK_TARGET('X', n == 0 ? 1000 : 100);
    }
}

TEST_MAIN(RUN(the_tick_that_sees_the_edge_drives);
          RUN(an_edge_that_the_main_loop_takes_before_a_tick_counts_in_the_next_tick);
          RUN(bare_rm_takes_the_plan_that_is_there);
          RUN(a_line_puts_the_plan_in_doubt_until_it_is_looked_at_again);
          RUN(an_axis_that_still_settles_begins_too);
          RUN(settings_that_make_another_plan_make_it); RUN(all_axes_of_a_step_begin_or_none);
          RUN(what_is_prepared_gives_way_to_any_other_motion);
          RUN(a_step_beyond_a_limit_is_clipped_and_logged_as_any_move);
          RUN(edges_before_the_start_are_not_heard_and_later_ones_are);
          RUN(it_is_busy_from_the_first_point_to_the_last); RUN(each_point_gives_a_pulse);
          RUN(a_move_or_a_halt_between_points_ends_it))
