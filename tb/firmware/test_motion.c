/* SPDX-License-Identifier: BSD-2-Clause */
/* Owners, plans that are handed over, limit switches, emergency stop, faults: on the board. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "closed_loop.h"
#include "core/fault.h"
#include "modules/axis.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "port.h"

#define SEND(line) CHECK_TEXT(closed_loop_send(line), ":A \r\n")

/* An owner as another module would declare it. */
static bool yields;
static unsigned ended;
static enum motion_end last_end;

static bool yield(unsigned axis, const struct motion_owner *to)
{
    (void)axis;
    (void)to;
    return yields;
}

static void note_end(unsigned axis, enum motion_end why)
{
    (void)axis;
    ended++;
    last_end = why;
}

static const struct motion_owner other = {
    .name = "other", .busy = true, .holds = true, .letter = 'A', .yield = yield, .ended = note_end,
};
static const struct motion_owner quiet = {.name = "quiet", .busy = false, .letter = 'M'};

static void start(void)
{
    yields = false;
    ended = 0;
    motion_release(MOTION_AXES_ALL, &other);
    motion_release(MOTION_AXES_ALL, &quiet);
    fault_clear();
    closed_loop_start(NULL);
}

TEST(busy_before_the_acknowledge_and_until_arrival)
{
    start();
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    SEND("M X=500");
    CHECK(motion_busy());
    CHECK_TEXT(closed_loop_send("/"), "B\r\n");
    CHECK_TEXT(closed_loop_send("RS X? Y? Z?"), ":A BNN\r\n");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 2270);
    CHECK_TEXT(closed_loop_send("RS X"), ":A 10\r\n");
}

TEST(a_move_to_the_present_place_is_over_at_once)
{
    int ticks;

    start();
    SEND("M X=0");
    ticks = closed_loop_wait(1000);
    CHECK(ticks > 0 && ticks < 50);
}

TEST(axes_of_one_command_start_together)
{
    int first[4] = {-1, -1, -1, -1};

    start();
    SEND("M X=5000 Y=-5000 Z=5000 F=-5000");
    for (int n = 0; n < 100; n++) {
        closed_loop_tick();
        for (unsigned axis = 0; axis < 4; axis++) {
            struct axis_view view;

            axis_read(axis, &view);
            if (first[axis] < 0 && view.planned)
                first[axis] = n;
        }
    }
    CHECK(first[0] >= 0);
    CHECK(first[1] == first[0] && first[2] == first[0] && first[3] == first[0]);
}

TEST(the_pause_after_a_move_is_busy)
{
    int without, with;

    start();
    SEND("M X=100");
    without = closed_loop_wait(5000);
    SEND("WT X=40");
    SEND("M X=200");
    with = closed_loop_wait(5000);
    CHECK(with > 200 && with < without + 300);
    SEND("M X=300");
    closed_loop_run(150);
    CHECK_TEXT(closed_loop_send("RS X+"), ":A P\r\n");
}

TEST(the_status_byte_tells_the_phase_of_a_move)
{
    start();
    SEND("M X=20000");
    closed_loop_run(50);
    /* Commanded, enabled, motor on, joystick; ramping, up. */
    CHECK_TEXT(closed_loop_send("RS X Y"), ":A 63 10\r\n");
    closed_loop_run(500);
    CHECK_TEXT(closed_loop_send("RS X Y"), ":A 15 10\r\n");
    CHECK_TEXT(closed_loop_send("RS X+ Y+"), ":A B \r\n");
    closed_loop_run(1650);
    CHECK_TEXT(closed_loop_send("RS X Y"), ":A 31 10\r\n");
    CHECK_TEXT(closed_loop_send("RB X"), ":\x1f\r\n");
}

TEST(an_owner_may_refuse_another)
{
    start();
    CHECK(motion_claim(MOTION_AXIS(0), &other));
    CHECK_TEXT(closed_loop_send("M X=100 Y=100"), ":N-5\r\n");
    CHECK(motion_owner(0) == &other && motion_owner(1) != &other);
    CHECK_INT(ended, 0);
    SEND("M Y=100");
    motion_release(MOTION_AXIS(0), &other);
    SEND("M X=100");
    CHECK_INT(ended, 0);
}

TEST(an_owner_that_yields_is_told)
{
    start();
    yields = true;
    CHECK(motion_claim(MOTION_AXIS(0), &other));
    SEND("M X=100");
    CHECK_INT(ended, 1);
    CHECK_INT(last_end, MOTION_TAKEN);
    CHECK(motion_owner(0) != &other);
}

TEST(an_owner_that_holds_is_busy_between_its_motions)
{
    start();
    CHECK(motion_claim(MOTION_AXIS(0), &other));
    CHECK_TEXT(closed_loop_send("/"), "B\r\n");
    CHECK_TEXT(closed_loop_send("\\"), ":N-21\r\n");
    CHECK_INT(last_end, MOTION_HALTED);
    motion_release(MOTION_AXIS(0), &other);
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
}

TEST(a_motion_that_is_not_commanded_is_not_busy)
{
    struct motion_move move = {
        .axis = 1, .target_counts = 2000, .speed_counts_per_s = 45396, .ramp_ms = 20,
    };

    start();
    CHECK(motion_claim(MOTION_AXIS(1), &quiet));
    motion_start(&move, 1);
    closed_loop_run(50);
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    CHECK_TEXT(closed_loop_send("RS Y+"), ":A M\r\n");
    CHECK_TEXT(closed_loop_send("\\"), ":A \r\n");
}

TEST(a_plan_made_too_late_is_made_again)
{
    struct axis_view view;

    start();
    SEND("M X=1000");
    closed_loop_run(100);
    /* The main loop was held up: the set-point has gone on from where the plan would begin. */
    (void)axis_plan(0);
    axis_read(0, &view);
    axis_hand_over(0, view.generation - 1, axis_ticks(), true);
    CHECK_INT(axis_handover(0), AXIS_HANDOVER_PENDING);
    axis_tick();
    CHECK_INT(axis_handover(0), AXIS_HANDOVER_LATE);
    CHECK(motion_busy());
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 4540);
}

TEST(halt_before_the_motion_began_withdraws_it)
{
    start();
    SEND("M X=1000");
    CHECK(motion_halt());
    closed_loop_run(500);
    CHECK_INT(board_count(closed_loop_board(), 0), 0);
    CHECK(!motion_halt());
}

TEST(halt_ends_the_pause_after_a_move)
{
    start();
    SEND("WT X=30000");
    SEND("M X=100");
    closed_loop_run(500);
    CHECK_TEXT(closed_loop_send("RS X+"), ":A P\r\n");
    CHECK_TEXT(closed_loop_send("\\"), ":N-21\r\n");
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    CHECK_TEXT(closed_loop_send("\\"), ":A \r\n");
    closed_loop_run(50);
    CHECK_TEXT(closed_loop_send("RS X+"), ":A  \r\n");
    CHECK(motion_in_position(0));
}

TEST(a_halt_is_not_followed_by_a_pause)
{
    start();
    SEND("WT X=30000");
    SEND("M X=20000");
    closed_loop_run(500);
    CHECK_TEXT(closed_loop_send("\\"), ":N-21\r\n");
    closed_loop_run(500);
    CHECK(motion_in_position(0));
}

TEST(a_halt_that_got_no_answer_of_its_own_is_not_answered_later)
{
    start();
    SEND("M X=90000");
    closed_loop_run(1000);
    CHECK_TEXT(closed_loop_send("HALT ?"), ":N-3\r\n");
    closed_loop_run(500);
    CHECK_TEXT(closed_loop_send("HALT"), ":A \r\n");
    SEND("M X=0");
    closed_loop_run(500);
    /* The second HALT is dropped by the abort key; a reply that leaves slowly stood before it. */
    port_hold();
    port_queue("I X\rHALT\r\x1b");
    (void)port_take(1);
    CHECK(!motion_busy());
    for (int n = 0; n < 1000; n++)
        (void)port_take(8);
    port_queue("HALT\r");
    (void)port_take(0);
    CHECK_TEXT(port_take(100), ":A \r\n");
}

TEST(halt_takes_whatever_follows_it)
{
    start();
    SEND("M X=90000");
    closed_loop_run(1000);
    CHECK_TEXT(closed_loop_send("HALT X=1 Y? Z+"), ":N-21\r\n");
    CHECK_TEXT(closed_loop_send("HALT X"), ":A \r\n");
}

/* Each would otherwise put off what the one before began. */
TEST(halts_without_end_stop_as_fast_as_one)
{
    int once, many = 0;

    start();
    SEND("M X=90000");
    closed_loop_run(1000);
    (void)closed_loop_send("\\");
    for (once = 0; !motion_in_position(0); once++)
        closed_loop_tick();
    SEND("M X=-90000");
    closed_loop_run(1000);
    for (many = 0; many < 1000 && !motion_in_position(0); many++)
        (void)closed_loop_send("\\");
    CHECK(many < once + 100); /* the last counts take their time */
}

/* A plan begins some ticks after its command; each would put off the one before for ever. */
TEST(moves_that_follow_each_other_at_every_tick_move_the_axis)
{
    start();
    for (int n = 0; n < 1000; n++)
        CHECK_TEXT(closed_loop_send(n % 2 == 0 ? "M X=20000 Y=-20000" : "M X=20001 Y=-20001"),
                   ":A \r\n");
    CHECK(closed_loop_position(0) > 20000 && closed_loop_position(1) < -20000);
    CHECK_TEXT(closed_loop_send("M X?"), ":A X=20001.1\r\n");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 90797);
    for (int n = 0; n < 1000; n++)
        CHECK_TEXT(closed_loop_send("R X=1 Y=-1"), ":A \r\n");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 90797 + 5000);
}

TEST(halts_among_moves_stop_the_axis)
{
    start();
    SEND("M X=90000");
    closed_loop_run(1000);
    for (int n = 0; n < 500; n++) {
        (void)closed_loop_send("\\");
        (void)closed_loop_send("M X=90000");
    }
    (void)closed_loop_send("\\");
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    closed_loop_run(200);
    CHECK(motion_in_position(0));
    CHECK(closed_loop_position(0) < 45396);
}

TEST(an_axis_switched_off_and_on_within_a_tick_has_stopped)
{
    start();
    SEND("M X=90000");
    closed_loop_run(1000);
    SEND("MC X- X+");
    closed_loop_run(500);
    CHECK(motion_in_position(0));
    CHECK(closed_loop_position(0) < 45396);
    SEND("M X=1000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 4540);
}

TEST(relative_moves_start_from_the_target)
{
    start();
    SEND("R X=1000");
    SEND("R X=1000");
    SEND("R X=-500");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 4540 + 4540 - 2270);
}

TEST(after_halt_relative_moves_start_from_where_it_stopped)
{
    int32_t stopped;

    start();
    SEND("M X=90000");
    closed_loop_run(1000);
    CHECK_TEXT(closed_loop_send("\\"), ":N-21\r\n");
    stopped = motion_target_counts(0);
    SEND("R X=1000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), stopped + 4540);
}

static double limit_mm(unsigned axis)
{
    return closed_loop_position(axis) / 45396;
}

/* The switch is at 55 mm; the motor brakes by itself from 6.8 mm/s in some tenths of a mm. */
TEST(a_limit_switch_stops_the_motion_into_it)
{
    start();
    SEND("S X=6.8");
    SEND("M X=600000");
    CHECK(closed_loop_wait(60000) > 0);
    closed_loop_run(500);
    CHECK(limit_mm(0) >= 55 && limit_mm(0) < 55.2);
    CHECK_TEXT(closed_loop_send("RS X"), ":A 74\r\n");
    CHECK_TEXT(closed_loop_send("RS X-"), ":A U\r\n");
    CHECK_INT(fault_read(0), FAULT_LIMIT_UPPER);

    SEND("R X=1000");
    CHECK(closed_loop_wait(500) >= 0);
    closed_loop_run(200);
    CHECK(limit_mm(0) < 55.2);
    CHECK_INT(fault_read(0), FAULT_INTO_LIMIT_UPPER);

    SEND("M X=540000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK(fabs(limit_mm(0) - 54) < 0.001);
    CHECK_TEXT(closed_loop_send("RS X"), ":A 10\r\n");
}

TEST(the_lower_switch_does_the_same)
{
    start();
    SEND("S Y=6.8");
    SEND("M Y=-600000");
    CHECK(closed_loop_wait(60000) > 0);
    closed_loop_run(500);
    CHECK(limit_mm(1) <= -55 && limit_mm(1) > -55.2);
    CHECK_TEXT(closed_loop_send("RS Y"), ":A 138\r\n");
    CHECK_INT(fault_read(0), FAULT_LIMIT_LOWER);
}

TEST(the_emergency_stop_ends_everything_and_nothing_moves_after_it)
{
    double at;

    start();
    CHECK(motion_claim(MOTION_AXIS(2), &other));
    SEND("M X=50000 Y=50000");
    closed_loop_run(1000);
    board_set_input(closed_loop_board(), BOARD_ESTOP, 1);
    closed_loop_run(300);
    CHECK_INT(last_end, MOTION_DISABLED);
    motion_release(MOTION_AXIS(2), &other);
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    at = closed_loop_position(0);
    SEND("M X=0");
    closed_loop_run(100);
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    board_set_input(closed_loop_board(), BOARD_ESTOP, 0);
    closed_loop_run(1000);
    CHECK(fabs(closed_loop_position(0) - at) < 1);
    CHECK(motion_in_position(0));
}

TEST(a_disabled_axis_ignores_moves)
{
    start();
    SEND("MC X-");
    CHECK_TEXT(closed_loop_send("MC X? Y?"), ":A 0 1\r\n");
    CHECK_TEXT(closed_loop_send("RS X-"), ":A D\r\n");
    closed_loop_run(10);
    CHECK_TEXT(closed_loop_send("RS X"), ":A 8\r\n");
    SEND("M X=1000");
    CHECK_TEXT(closed_loop_send("/"), "N\r\n");
    closed_loop_run(500);
    CHECK_INT(board_count(closed_loop_board(), 0), 0);
    SEND("MC X+");
    closed_loop_run(200);
    SEND("M X=1000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 4540);
    CHECK_TEXT(closed_loop_send("MC X"), ":N-4\r\n");
}

TEST(a_cut_motor_wire_ends_as_a_dead_axis)
{
    int ticks;

    start();
    board_cut_pwm(closed_loop_board(), 1);
    SEND("M X=10000");
    ticks = closed_loop_wait(20000);
    CHECK(ticks > 0);
    CHECK_INT(fault_read(0), FAULT_AXIS_DEAD + 0);
    CHECK_TEXT(closed_loop_send("MC X?"), ":A 0\r\n");
    CHECK_TEXT(closed_loop_send("RS X"), ":A 8\r\n");
    board_cut_pwm(closed_loop_board(), 0);
    SEND("MC X+");
    closed_loop_run(200);
    SEND("M X=1000");
    CHECK(closed_loop_wait(5000) > 0);
    CHECK_INT(board_count(closed_loop_board(), 0), 4540);
}

/* With a gain far too high it swings about its target for ever. */
TEST(an_axis_that_never_settles_is_given_up)
{
    start();
    SEND("KP X=32767");
    SEND("KD X=0");
    SEND("M X=1000");
    CHECK(closed_loop_wait(5000) > 2500);
    CHECK_INT(fault_read(0), FAULT_ADJUST_MOVE + 0);
    closed_loop_run(500);
    CHECK(motion_in_position(0));
    CHECK(fabs(closed_loop_position(0) - 4540) < 1000);
}

/* It runs away from the set-point: stopped beyond RUNAWAY after 10 ms of it. */
TEST(a_reversed_motor_ends_as_a_runaway)
{
    struct axis_view view;

    start();
    closed_loop_reverse(0, true);
    SEND("RU X=0.5");
    SEND("M X=1000");
    CHECK(closed_loop_wait(20000) > 0);
    CHECK_INT(fault_read(0), FAULT_RUNAWAY + 0);
    closed_loop_run(500);
    axis_read(0, &view);
    CHECK(view.off && view.duty_steps == 0);
    /* Half a mm, what the drive adds in 10 ms, and the way it brakes. */
    CHECK(fabs(closed_loop_position(0)) < 0.9 * 45396);
    closed_loop_reverse(0, false);
}

TEST_MAIN(RUN(busy_before_the_acknowledge_and_until_arrival);
          RUN(a_move_to_the_present_place_is_over_at_once);
          RUN(axes_of_one_command_start_together);
          RUN(the_pause_after_a_move_is_busy);
          RUN(the_status_byte_tells_the_phase_of_a_move);
          RUN(an_owner_may_refuse_another);
          RUN(an_owner_that_yields_is_told);
          RUN(an_owner_that_holds_is_busy_between_its_motions);
          RUN(a_motion_that_is_not_commanded_is_not_busy);
          RUN(a_plan_made_too_late_is_made_again);
          RUN(halt_before_the_motion_began_withdraws_it);
          RUN(halt_ends_the_pause_after_a_move);
          RUN(a_halt_is_not_followed_by_a_pause);
          RUN(a_halt_that_got_no_answer_of_its_own_is_not_answered_later);
          RUN(halt_takes_whatever_follows_it);
          RUN(halts_without_end_stop_as_fast_as_one);
          RUN(moves_that_follow_each_other_at_every_tick_move_the_axis);
          RUN(halts_among_moves_stop_the_axis);
          RUN(an_axis_switched_off_and_on_within_a_tick_has_stopped);
          RUN(relative_moves_start_from_the_target);
          RUN(after_halt_relative_moves_start_from_where_it_stopped);
          RUN(a_limit_switch_stops_the_motion_into_it);
          RUN(the_lower_switch_does_the_same);
          RUN(the_emergency_stop_ends_everything_and_nothing_moves_after_it);
          RUN(a_disabled_axis_ignores_moves);
          RUN(a_cut_motor_wire_ends_as_a_dead_axis);
          RUN(an_axis_that_never_settles_is_given_up);
          RUN(a_reversed_motor_ends_as_a_runaway))
