/* SPDX-License-Identifier: BSD-2-Clause */
/* What a pulse at IN0 starts: ring buffer, Z-stack, repeated moves, reports, OUT0; and its pulses. */
#include "check.h"

#include <math.h>

#include "core/action.h"
#include "core/events.h"
#include "host/mmio.h"
#include "machine.h"
#include "modules/motion.h"
#include "port.h"
#include "regs.h"

#define SEND(text, reply) CHECK_TEXT(machine_send(text), reply)
#define DONE ":A \r\n"
#define TICKS_PER_MS 5u

static void start(void)
{
    machine_start();
    machine_run(200);
}

/* A rising edge at IN0, and the falling one. */
static void trigger(void)
{
    events_publish(EVENT_TRIGGER_IN, 1, events_now());
    events_publish(EVENT_TRIGGER_IN, 0, events_now());
    machine_run(1);
}

static unsigned out0(void)
{
    return (mmio_model_get(REG_ROUTER_OUT0) & REG_ROUTER_OUT0_SOURCE_MASK) >>
           REG_ROUTER_OUT0_SOURCE_SHIFT;
}

TEST(ring_buffer_goes_round_its_points)
{
    start();
    SEND("RM X=0", DONE);
    SEND("LD X=100 Y=200", DONE);
    SEND("LD X=300 Z=500", DONE);
    SEND("RM X? Y? Z? F?", ":A X=2 Y=3 Z=0 F=1\r\n");
    SEND("LD X? Y? Z?", ":A X=100.0 Y=200.0 Z=0.0\r\n");
    SEND("TTL X=1", DONE);
    trigger();
    CHECK_TARGET('X', 100);
    CHECK_TARGET('Y', 200);
    SEND("/", "B\r\n");
    SEND("RM Z?", ":A Z=1\r\n");
    SEND("RM", DONE); /* as a pulse does */
    CHECK_TARGET('X', 300);
    CHECK_TARGET('Y', 200); /* not named: stays */
    CHECK_TARGET('Z', 0);   /* named, but not among the axes that move */
    SEND("RM Z?", ":A Z=0\r\n");
    SEND("RM Y=4 Z=1", DONE);
    trigger();
    CHECK_TARGET('Z', 500);
    CHECK_TARGET('X', 300);
}

TEST(ring_buffer_moves_by_distances_in_mode_12)
{
    start();
    SEND("LD X=100", DONE);
    SEND("TTL X=12", DONE);
    for (int n = 1; n <= 3; n++)
        trigger();
    CHECK_TARGET('X', 300);
}

TEST(ring_buffer_takes_fifty_points)
{
    start();
    for (int n = 0; n < 50; n++)
        SEND("LD X=1", DONE);
    SEND("LD X=1", ":N-5\r\n");
    SEND("RM X?", ":A X=50\r\n");
    SEND("RM Z=49", DONE);
    SEND("RM Z=50", ":N-4\r\n");
    SEND("RM X=0", DONE);
    SEND("RM Z=1", ":N-4\r\n");
    SEND("RM X=1", ":N-4\r\n"); /* no ARRAY */
    SEND("LD Q=1", ":N-2\r\n");
    SEND("LD", ":N-3\r\n");
    CHECK(strstr(machine_send("BU X"), "\rRING BUFFER 50") != NULL);
}

TEST(ring_buffer_stores_the_place_it_is_at)
{
    start();
    SEND("M X=500", DONE);
    CHECK(machine_wait());
    SEND("LD X+ Y=7", DONE);
    double x, y;
    CHECK_INT(sscanf(machine_send("LD X? Y?"), ":A X=%lf Y=%lf", &x, &y), 2);
    CHECK(fabs(x - 500) < 1 && y == 7);
    SEND("LD X=1e300", ":N-4\r\n");
}

TEST(ring_buffer_drops_points_it_has_gone_to_in_mode_4)
{
    start();
    SEND("LD X=100", DONE);
    SEND("LD X=200", DONE);
    SEND("RM F=4", DONE);
    SEND("RM X?", ":A X=48\r\n");
    SEND("TTL X=1", DONE);
    trigger();
    CHECK_TARGET('X', 100);
    SEND("RM X?", ":A X=49\r\n");
    trigger();
    CHECK_TARGET('X', 200);
    SEND("RM X?", ":A X=50\r\n");
    trigger();
    CHECK_TARGET('X', 200);
}

TEST(ring_buffer_plays_once_and_round)
{
    start();
    SEND("RT Z=1000", DONE);
    SEND("LD X=100", DONE);
    SEND("LD X=200", DONE);
    SEND("LD X=300", DONE);
    SEND("RM F=2", DONE);
    SEND("TTL X=1", DONE);
    trigger();
    CHECK_TARGET('X', 100);
    SEND("RM F?", ":A F=130\r\n");
    machine_run(1100 * TICKS_PER_MS);
    CHECK_TARGET('X', 200);
    machine_run(1000 * TICKS_PER_MS);
    CHECK_TARGET('X', 300);
    SEND("RM F?", ":A F=2\r\n");
    machine_run(2000 * TICKS_PER_MS);
    CHECK_TARGET('X', 300);
    SEND("RM F=3", DONE);
    trigger();
    machine_run(3100 * TICKS_PER_MS);
    CHECK_TARGET('X', 100);
    trigger(); /* stops it */
    machine_run(3000 * TICKS_PER_MS);
    CHECK_TARGET('X', 100);
    trigger();
    SEND("\\", ":N-21\r\n"); /* and so does HALT */
    machine_run(3000 * TICKS_PER_MS);
    SEND("RM F?", ":A F=3\r\n");
}

TEST(buttons_work_the_ring_buffer)
{
    start();
    CHECK(!action_perform(ACTION_AT_SHORT)); /* nothing stored: for others */
    SEND("M X=500", DONE);
    CHECK(machine_wait());
    CHECK(action_perform(ACTION_JOYSTICK_LONG));
    SEND("M X=0", DONE);
    CHECK(machine_wait());
    CHECK(action_perform(ACTION_AT_SHORT));
    CHECK_TARGET('X', 500);
    SEND("RM X?", ":A X=1\r\n");
    CHECK(action_perform(ACTION_HOME_LONG));
    SEND("RM X?", ":A X=0\r\n");
}

TEST(repeats_the_last_relative_move)
{
    start();
    SEND("R X=0 Y=0 Z=20", DONE);
    SEND("TTL X=2", DONE);
    trigger();
    trigger();
    CHECK_TARGET('Z', 60);
    CHECK_TARGET('X', 0);
    SEND("ZS X=50", DONE); /* or what ZS says, for the focus */
    trigger();
    CHECK_TARGET('Z', 110);
}

TEST(z_stack_as_a_sawtooth)
{
    static const double places[] = {900, 1000, 1100, 900, 1000};

    start();
    SEND("M Z=1000", DONE);
    CHECK(machine_wait());
    SEND("ZS X=100 Y=3 Z=0 F=0", DONE);
    SEND("TTL X=4", DONE);
    SEND("ZS M? T?", ":A T=0 M=0\r\n");
    for (unsigned n = 0; n < 5; n++) {
        trigger();
        CHECK_TARGET('Z', places[n]);
    }
    SEND("ZS T? M?", ":A T=1 M=1\r\n");
    SEND("ZS M=0", DONE);
    CHECK_TARGET('Z', 1000);
    SEND("ZS M=1", ":N-4\r\n");
}

TEST(z_stack_as_a_triangle)
{
    static const double places[] = {-100, 0, 100, 0, -100, 0};

    start();
    SEND("ZS X=100 Y=3 Z=1 F=0", DONE);
    SEND("TTL X=4", DONE);
    for (unsigned n = 0; n < 6; n++) {
        trigger();
        CHECK_TARGET('Z', places[n]);
        if (n == 3)
            SEND("ZS M? T?", ":A T=1 M=2\r\n");
    }
}

TEST(z_stack_goes_back_after_its_time_out)
{
    start();
    SEND("ZS X=100 Y=5 F=100", DONE);
    SEND("TTL X=4", DONE);
    trigger();
    CHECK_TARGET('Z', -200);
    machine_run(90 * TICKS_PER_MS);
    trigger();
    machine_run(90 * TICKS_PER_MS);
    CHECK_TARGET('Z', -100);
    machine_run(20 * TICKS_PER_MS);
    CHECK_TARGET('Z', 0);
    SEND("ZS M?", ":A M=0\r\n");
}

TEST(z_stack_steps_are_whole_counts)
{
    start();
    SEND("ZS X=1 Y=32767 F=32767", DONE);
    SEND("ZS X?", ":A X=0.881135\r\n"); /* 4 of 4.5396 counts */
    SEND("ZS Y=0", ":N-4\r\n");
    SEND("ZS Y=32768", ":N-4\r\n");
    SEND("ZS T=0", ":N-4\r\n");
    SEND("ZS X=-10000 Y=32767", DONE); /* ends far beyond the travel */
    SEND("TTL X=4", DONE);
    trigger();
    CHECK(machine_target('Z') > 1e6);
}

TEST(reports_positions_in_time)
{
    start();
    SEND("RT X=100", DONE);
    SEND("RT X=19", ":N-4\r\n");
    SEND("RM Y=5", DONE);
    SEND("TTL X=5", DONE);
    machine_run(500);
    CHECK_TEXT(port_drain(), "");
    trigger();
    machine_run(10 * TICKS_PER_MS);
    CHECK_TEXT(port_drain(), ":A 0.0 0.0 \r\n");
    machine_run(200 * TICKS_PER_MS);
    CHECK_TEXT(port_drain(), ":A 0.0 0.0 \r\n:A 0.0 0.0 \r\n");
    SEND("TTL X=0", DONE);
    machine_run(1000);
    CHECK_TEXT(port_drain(), "");
}

TEST(toggles_out0)
{
    start();
    SEND("TTL X=10 Y=0", DONE);
    trigger();
    SEND("TTL", ":A 1\r\n");
    trigger();
    SEND("TTL", ":A 0\r\n");
    SEND("TTL F=-1", DONE);
    SEND("TTL", ":A 1\r\n");
    trigger();
    SEND("TTL", ":A 0\r\n");
}

/* Ticks for which OUT0 is high from now on, at most `limit`; first it is waited for as long. */
static unsigned high_ticks(unsigned limit)
{
    unsigned ticks = 0;

    for (unsigned n = 0; out0() == 0 && n < limit; n++)
        machine_run(1);
    for (; out0() == 1 && ticks < limit; ticks++)
        machine_run(1);
    return ticks;
}

TEST(gives_a_pulse_at_the_end_of_a_move)
{
    start();
    SEND("TTL Y=2", DONE);
    SEND("RT Y=20", DONE);
    CHECK_INT(out0(), 0);
    SEND("M X=1000", DONE);
    machine_run(20);
    CHECK_INT(out0(), 0);
    unsigned ticks = high_ticks(5000);
    CHECK(ticks >= 99 && ticks <= 101);
    CHECK(!motion_busy());
    SEND("RT Y=0.1", DONE); /* what a laboratory sends */
    SEND("RT Y?", ":A Y=0.1\r\n");
}

TEST(cuts_the_pulse_short_when_a_move_starts)
{
    start();
    SEND("TTL Y=2", DONE);
    SEND("RT Y=1000", DONE);
    SEND("M X=100", DONE);
    CHECK(machine_wait());
    machine_run(5);
    CHECK_INT(out0(), 1);
    SEND("M X=0", DONE);
    machine_run(2);
    CHECK_INT(out0(), 0);
}

TEST(gives_no_pulse_after_a_halt)
{
    start();
    SEND("TTL Y=2", DONE);
    SEND("M X=10000", DONE);
    machine_run(500);
    SEND("\\", ":N-21\r\n");
    CHECK_INT(high_ticks(2000), 0);
}

TEST(shows_constant_speed)
{
    start();
    SEND("TTL Y=4", DONE); /* the second axis */
    SEND("S Y=1", DONE);
    SEND("AC Y=100", DONE);
    SEND("M X=5000", DONE);
    CHECK_INT(high_ticks(3000), 0);
    SEND("M Y=5000", DONE); /* 0.5 mm at 1 mm/s: 0.4 s between ramps of 0.1 s */
    machine_run(490);
    CHECK_INT(out0(), 0);
    unsigned ticks = high_ticks(4000);
    CHECK(ticks > 1970 && ticks < 2030);
}

TEST_MAIN(RUN(ring_buffer_goes_round_its_points);
          RUN(ring_buffer_moves_by_distances_in_mode_12); RUN(ring_buffer_takes_fifty_points);
          RUN(ring_buffer_stores_the_place_it_is_at);
          RUN(ring_buffer_drops_points_it_has_gone_to_in_mode_4);
          RUN(ring_buffer_plays_once_and_round); RUN(buttons_work_the_ring_buffer);
          RUN(repeats_the_last_relative_move); RUN(z_stack_as_a_sawtooth);
          RUN(z_stack_as_a_triangle); RUN(z_stack_goes_back_after_its_time_out);
          RUN(z_stack_steps_are_whole_counts); RUN(reports_positions_in_time);
          RUN(toggles_out0); RUN(gives_a_pulse_at_the_end_of_a_move);
          RUN(cuts_the_pulse_short_when_a_move_starts); RUN(gives_no_pulse_after_a_halt);
          RUN(shows_constant_speed))
