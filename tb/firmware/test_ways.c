/* SPDX-License-Identifier: BSD-2-Clause */
/* SPIN, VECTOR, HOME, BACKLASH, OVERSHOOT, MAINTAIN and the limits' letters, on the board model. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "closed_loop.h"
#include "core/fault.h"
#include "modules/axis.h"
#include "modules/motion.h"

#define SEND(line) CHECK_TEXT(closed_loop_send(line), ":A \r\n")

enum { MM = 45396, TICKS_PER_MS = 1000 / CLOSED_LOOP_TICK_US };

static void start(void)
{
    fault_clear();
    closed_loop_start(NULL);
    SEND("SL X- Y-");
    SEND("SU X- Y-");
    SEND("HM X- Y-");
}

static double speed_mm_per_s(unsigned axis, unsigned ms)
{
    double before = closed_loop_position(axis);

    closed_loop_run(ms * TICKS_PER_MS);
    return (closed_loop_position(axis) - before) / MM / ms * 1000;
}

/* Steady speed of the board model: 7.48 mm/s at full drive, friction of 0.1 taken off the drive. */
static double open_loop_mm_per_s(double share)
{
    return 7.48 / 0.9 * (share - 0.1);
}

TEST(a_spin_drives_open_loop_and_shows_in_bit_0)
{
    start();
    SEND("@ X=100 Y=-64 Z");
    closed_loop_run(60 * TICKS_PER_MS);
    CHECK(fabs(speed_mm_per_s(0, 50) - open_loop_mm_per_s(100 / 127.0)) < 0.02);
    CHECK(fabs(speed_mm_per_s(1, 50) + open_loop_mm_per_s(64 / 127.0)) < 0.02);
    CHECK(closed_loop_position(2) < 10);
    CHECK_TEXT(closed_loop_send("RS X Y Z"), ":A 15 15 10\r\n");
    CHECK_TEXT(closed_loop_send("RS X+ Y+ Z+"), ":A SS \r\n");
    CHECK_TEXT(closed_loop_send("/"), "B\r\n");
    SEND("@ X Y=0");
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK_TEXT(closed_loop_send("RS X Y"), ":A 10 10\r\n");
    CHECK(fabs(speed_mm_per_s(0, 20)) < 1e-9);
}

TEST(halting_a_spin_is_no_interrupted_move)
{
    start();
    SEND("@ X=127");
    closed_loop_run(50 * TICKS_PER_MS);
    SEND("\\");
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK(fabs(speed_mm_per_s(0, 20)) < 1e-9);
    SEND("@ X=127");
    SEND("M Y=1000");
    CHECK_TEXT(closed_loop_send("\\"), ":N-21\r\n");
}

TEST(rates_beyond_the_range_are_refused_whole)
{
    start();
    CHECK_TEXT(closed_loop_send("@ Y=50 X=129"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("@"), ":N-3\r\n");
    closed_loop_run(20 * TICKS_PER_MS);
    CHECK(fabs(closed_loop_position(1)) < 2);
    SEND("@ X=128 Y=-128");
}

/* As python-microscope homes: SPIN, wait for bit 0, name the place, and back. */
TEST(a_spin_ends_at_the_limit_switch)
{
    start();
    SEND("@ X=-127");
    for (int n = 0; n < 12000 && motion_axis_busy(0); n++)
        closed_loop_run(TICKS_PER_MS);
    CHECK(!motion_axis_busy(0));
    CHECK(closed_loop_position(0) < -55 * MM && closed_loop_position(0) > -55.3 * MM);
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK_TEXT(closed_loop_send("RS X"), ":A 138\r\n");
    SEND("H X=0");
    SEND("@ X=-50");
    closed_loop_run(50 * TICKS_PER_MS);
    CHECK(!motion_axis_busy(0) && closed_loop_position(0) > -55.3 * MM);
    SEND("M X=20000");
    CHECK(closed_loop_wait(20000) > 0);
    CHECK_TEXT(closed_loop_send("W X"), ":A 20000.0 \r\n");
}

TEST(a_spin_ends_at_the_soft_limit)
{
    start();
    SEND("SU X=1");
    SEND("@ X=60");
    closed_loop_run(1000 * TICKS_PER_MS);
    CHECK(!motion_axis_busy(0));
    CHECK(closed_loop_position(0) > MM && closed_loop_position(0) < 1.1 * MM);
    CHECK_INT(fault_read(0), FAULT_LIMIT_UPPER);
}

TEST(a_move_takes_a_spinning_axis)
{
    start();
    SEND("@ X=127");
    closed_loop_run(50 * TICKS_PER_MS);
    SEND("M X=500");
    CHECK(motion_busy());
    CHECK(closed_loop_wait(20000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 2270);
}

TEST(a_vector_is_a_velocity_and_not_busy)
{
    start();
    SEND("VE X=0.5 Y=-1.25");
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK(fabs(speed_mm_per_s(0, 200) - 0.5) < 0.0005);
    CHECK(fabs(speed_mm_per_s(1, 200) + 1.25) < 0.0005);
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    CHECK_TEXT(closed_loop_send("RS X+"), ":A M\r\n");
    CHECK_TEXT(closed_loop_send("VE X? Y?"), ":A X=0.500000 Y=-1.250000\r\n");
    /* To another velocity with the acceleration of ACCEL and SPEED, 4.556 mm/s in 50 ms. */
    SEND("VE X=-0.5");
    closed_loop_run(60 * TICKS_PER_MS);
    CHECK(fabs(speed_mm_per_s(0, 200) + 0.5) < 0.0005);
    SEND("VE X=0");
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK(fabs(speed_mm_per_s(0, 50)) < 1e-9);
    CHECK(fabs(speed_mm_per_s(1, 200) + 1.25) < 0.0005);
    SEND("\\");
    CHECK_TEXT(closed_loop_send("VE Y?"), ":A Y=0.000000\r\n");
}

/* 20 um/s down to 1 nm/s: no slowest speed. A count is 22 nm, so at 1 nm/s it shows in the set-point. */
TEST(a_vector_has_no_slowest_speed)
{
    struct axis_view before, after;

    start();
    SEND("VE X=0.00002");
    closed_loop_run(1000 * TICKS_PER_MS);
    /* It sticks and slips by some five counts; 91 pass in the time. */
    CHECK(fabs(speed_mm_per_s(0, 100000) - 0.00002) < 0.000002);
    SEND("VE X=1e-6");
    closed_loop_run(1000 * TICKS_PER_MS);
    axis_read(0, &before);
    closed_loop_run(10000 * TICKS_PER_MS);
    axis_read(0, &after);
    CHECK(fabs((double)(after.setpoint.position_q32 - before.setpoint.position_q32) / 4294967296.0 -
               1e-5 * MM) < 1e-4);
}

TEST(a_vector_ends_at_the_limit)
{
    start();
    SEND("SU X=0.5");
    SEND("VE X=5");
    closed_loop_run(400 * TICKS_PER_MS);
    CHECK_INT(board_count(closed_loop_board(), 0), MM / 2);
    CHECK_TEXT(closed_loop_send("RS X-"), ":A U\r\n");
    CHECK_TEXT(closed_loop_send("VE X?"), ":A X=0.000000\r\n");
    SEND("VE X=1000");
    closed_loop_run(20 * TICKS_PER_MS);
    CHECK_TEXT(closed_loop_send("VE X?"), ":A X=0.000000\r\n");
    SEND("VE X=-1000");
    CHECK_TEXT(closed_loop_send("VE X?"), ":A X=-6.800000\r\n");
    closed_loop_run(20 * TICKS_PER_MS);
    CHECK_TEXT(closed_loop_send("VE X?"), ":A X=-6.800000\r\n");
}

TEST(home_is_a_commanded_move_to_the_limit_or_its_place)
{
    start();
    SEND("SU X=2");
    SEND("! X");
    CHECK_TEXT(closed_loop_send("/"), "B\r\n");
    CHECK_TEXT(closed_loop_send("RS X+"), ":A B\r\n");
    CHECK(closed_loop_wait(20000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 2 * MM);
    SEND("HM X=-1");
    SEND("H X=50000");
    CHECK_TEXT(closed_loop_send("HM X?"), ":A X=2.000\r\n"); /* 3 mm before here, which is 5 now */
    SEND("HOME X");
    CHECK(closed_loop_wait(20000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), -MM);
    CHECK_TEXT(closed_loop_send("!"), ":N-3\r\n");
    SEND("HM X+ Y-");
    CHECK_TEXT(closed_loop_send("HM X? Y?"), ":A X=2.000 Y=1000.000\r\n");
}

/* The least and the most of the set-point on the way, counts. */
static void extremes(const char *line, double *least, double *most)
{
    SEND(line);
    *least = 1e9;
    *most = -1e9;
    while (motion_busy()) {
        struct axis_view view;
        double at;

        closed_loop_tick();
        axis_read(0, &view);
        at = (double)view.setpoint.position_q32 / 4294967296.0;
        *least = fmin(*least, at);
        *most = fmax(*most, at);
    }
}

TEST(the_last_way_is_upward_with_backlash)
{
    double least, most;

    start();
    SEND("B X=0.04");
    CHECK_TEXT(closed_loop_send("B X?"), ":X=0.040000 A\r\n");
    extremes("M X=-1000", &least, &most);
    CHECK(fabs(least - (-4540 - 1815)) < 1 && most < 1);
    CHECK_INT(board_count(closed_loop_board(), 0), -4540);
    /* From below it comes straight. */
    extremes("M X=1000", &least, &most);
    CHECK(least >= -4540 && most <= 4540);
    /* Unless the way is shorter than the backlash. */
    extremes("R X=100", &least, &most);
    CHECK(fabs(least - (4540 + 454 - 1815)) < 1);
    CHECK_INT(board_count(closed_loop_board(), 0), 4540 + 454);
    /* Upward is the user's direction. */
    SEND("UM X=-10000");
    extremes("R X=-1000", &least, &most);
    CHECK(fabs(most - (4994 + 4540 + 1815)) < 1);
    SEND("UM X=10000");
}

TEST(a_target_is_passed_by_the_overshoot)
{
    double least, most;

    start();
    SEND("OS X=0.05");
    CHECK_TEXT(closed_loop_send("OS X?"), ":A X=0.049982\r\n"); /* 2269 counts */
    SEND("C X=13490.4"); /* 674 counts now */
    CHECK_TEXT(closed_loop_send("OS X?"), ":A X=0.049961\r\n");
    SEND("C X=45396");
    CHECK_TEXT(closed_loop_send("OS X?"), ":A X=0.049982\r\n");
    extremes("M X=1000", &least, &most);
    CHECK(fabs(most - (4540 + 2269)) < 1 && least > -1);
    CHECK_INT(board_count(closed_loop_board(), 0), 4540);
    extremes("M X=0", &least, &most);
    CHECK(fabs(least + 2269) < 1);
    SEND("B X=0.1");
    extremes("M X=-1000", &least, &most);
    CHECK(fabs(least - (-4540 - 4539)) < 1 || fabs(least - (-4540 - 2269)) < 1);
    CHECK_INT(board_count(closed_loop_board(), 0), -4540);
    extremes("M X=-1000", &least, &most); /* nowhere to go */
    CHECK(least > -4541 && most < -4539);
}

TEST(a_halt_forgets_the_rest_of_the_way)
{
    start();
    SEND("B X=1");
    SEND("M X=-20000");
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK_TEXT(closed_loop_send("\\"), ":N-21\r\n");
    closed_loop_run(300 * TICKS_PER_MS);
    CHECK(motion_in_position(0) && !motion_busy());
    CHECK(closed_loop_position(0) > -MM && closed_loop_position(0) < 0);
    CHECK_INT(motion_target_counts(0), board_count(closed_loop_board(), 0));
}

TEST(an_axis_that_holds_stays_on_and_corrects_at_once)
{
    start();
    SEND("MA X=2");
    SEND("M X=100");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_TEXT(closed_loop_send("RS X"), ":A 14\r\n"); /* motor on, not busy */
    closed_loop_push(0, 0.25);
    closed_loop_run(500 * TICKS_PER_MS);
    CHECK(fabs(closed_loop_position(0) - 454) < 12);
    closed_loop_push(0, 0);
    closed_loop_run(200 * TICKS_PER_MS);
    CHECK(fabs(closed_loop_position(0) - 454) < 12);
    CHECK_TEXT(closed_loop_send("MA X=4"), ":N-4\r\n");
    SEND("MA X=0");
}

TEST(a_released_move_is_not_busy_in_its_pause)
{
    int pausing, releasing;

    start();
    SEND("WT X=100");
    SEND("M X=100");
    pausing = closed_loop_wait(5000);
    SEND("MA X=3");
    SEND("M X=200");
    releasing = closed_loop_wait(5000);
    CHECK(releasing < pausing - 95 * TICKS_PER_MS);
    CHECK_TEXT(closed_loop_send("RS X"), ":A 14\r\n");
    closed_loop_run(110 * TICKS_PER_MS);
    CHECK_TEXT(closed_loop_send("RS X"), ":A 10\r\n");
}

/* Correcting for ever does not give up where 0.5 s would have been too long. */
TEST(an_axis_may_be_told_never_to_give_up)
{
    start();
    SEND("KP X=32767");
    SEND("KD X=0");
    SEND("MA X=1");
    SEND("M X=1000");
    closed_loop_run(2000 * TICKS_PER_MS);
    CHECK(motion_busy());
    CHECK_INT(fault_read(0) == FAULT_ADJUST_MOVE, 0);
    CHECK_TEXT(closed_loop_send("\\"), ":N-21\r\n");
}

TEST(limits_have_the_users_letters)
{
    start();
    SEND("UM X=-10000");
    SEND("@ X=-127"); /* down for the user, up for the encoder */
    for (int n = 0; n < 12000 && motion_axis_busy(0); n++)
        closed_loop_run(TICKS_PER_MS);
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK(closed_loop_position(0) > 54 * MM);
    CHECK_TEXT(closed_loop_send("RS X-"), ":A L\r\n");
    CHECK_TEXT(closed_loop_send("RS X"), ":A 138\r\n");
    SEND("UM X=10000");
    CHECK_TEXT(closed_loop_send("RS X-"), ":A U\r\n");
    CHECK_TEXT(closed_loop_send("RS X"), ":A 74\r\n");
}

TEST(limits_have_the_users_codes)
{
    start();
    SEND("UM X=-10000 Y=10000");
    SEND("S X=6.8 Y=6.8");
    SEND("SL X=-5");
    SEND("SU X=3");
    fault_clear();
    SEND("M X=-60000 Y=0"); /* beyond the soft limits */
    CHECK_INT(fault_read(0), FAULT_LIMIT_LOWER);
    CHECK(closed_loop_wait(100000) > 0);
    CHECK(fabs(closed_loop_position(0) - 5 * MM) < 2);
    SEND("M X=60000");
    CHECK_INT(fault_read(0), FAULT_LIMIT_UPPER);
    CHECK(closed_loop_wait(100000) > 0);
    CHECK(fabs(closed_loop_position(0) + 3 * MM) < 2);
    SEND("@ X=-127");
    while (motion_axis_busy(0))
        closed_loop_tick();
    CHECK_INT(fault_read(0), FAULT_LIMIT_LOWER);
    closed_loop_run(100 * TICKS_PER_MS);

    SEND("SL X-"); /* the switches */
    SEND("SU X-");
    SEND("M X=-600000");
    CHECK(closed_loop_wait(100000) > 0);
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK(closed_loop_position(0) > 54 * MM);
    CHECK_INT(fault_read(0), FAULT_LIMIT_LOWER);
    SEND("R X=-1000");
    CHECK(closed_loop_wait(5000) >= 0);
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK_INT(fault_read(0), FAULT_INTO_LIMIT_LOWER);
    SEND("M X=600000");
    CHECK(closed_loop_wait(100000) > 0);
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK_INT(fault_read(0), FAULT_LIMIT_UPPER);
    SEND("R X=1000");
    CHECK(closed_loop_wait(5000) >= 0);
    closed_loop_run(100 * TICKS_PER_MS);
    CHECK_INT(fault_read(0), FAULT_INTO_LIMIT_UPPER);
}

TEST(the_screw_brings_its_scale_and_speed)
{
    start();
    SEND("SCREW X=25.4");
    CHECK_TEXT(closed_loop_send("C X?"), ":X=11349.0 A\r\n");
    SEND("S X=1000");
    CHECK_TEXT(closed_loop_send("S X? Y?"), ":A X=26.000000 Y=4.556000\r\n");
    CHECK_TEXT(closed_loop_send("SCREW X=5"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("SCREW X? Y?"), ":A X=25.4000 Y=6.3500\r\n");
}

TEST_MAIN(RUN(a_spin_drives_open_loop_and_shows_in_bit_0);
          RUN(halting_a_spin_is_no_interrupted_move);
          RUN(rates_beyond_the_range_are_refused_whole);
          RUN(a_spin_ends_at_the_limit_switch);
          RUN(a_spin_ends_at_the_soft_limit);
          RUN(a_move_takes_a_spinning_axis);
          RUN(a_vector_is_a_velocity_and_not_busy);
          RUN(a_vector_has_no_slowest_speed);
          RUN(a_vector_ends_at_the_limit);
          RUN(home_is_a_commanded_move_to_the_limit_or_its_place);
          RUN(the_last_way_is_upward_with_backlash);
          RUN(a_target_is_passed_by_the_overshoot);
          RUN(a_halt_forgets_the_rest_of_the_way);
          RUN(an_axis_that_holds_stays_on_and_corrects_at_once);
          RUN(a_released_move_is_not_busy_in_its_pause);
          RUN(an_axis_may_be_told_never_to_give_up);
          RUN(limits_have_the_users_letters);
          RUN(limits_have_the_users_codes);
          RUN(the_screw_brings_its_scale_and_speed))
