/* SPDX-License-Identifier: BSD-2-Clause */
/* User units, mirrored axes, origins, soft limits: through the language and the board model. */
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "closed_loop.h"
#include "core/fault.h"
#include "modules/axis.h"
#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "rig.h"

#define SEND(line) CHECK_TEXT(closed_loop_send(line), ":A \r\n")

TEST(a_place_is_the_nearest_count)
{
    closed_loop_start(NULL);
    CHECK_INT(coordinates_user_to_counts(0, 10000), 45396);
    CHECK_INT(coordinates_user_to_counts(0, -10000), -45396);
    CHECK_INT(coordinates_user_to_counts(0, 0.11), 0);
    CHECK_INT(coordinates_user_to_counts(0, 0.12), 1);
    CHECK_INT(coordinates_user_to_counts(0, -0.12), -1);
    CHECK_INT(coordinates_mm_to_counts(0, 1), 45396);
}

TEST(counts_and_user_units_are_inverse)
{
    closed_loop_start(NULL);
    srand(1);
    SEND("UM X=-10000 Y=1000 Z=25400");
    SEND("C X=13490.4 Y=181590.4 Z=655360");
    SEND("H X=1234.5 Y=-0.3 Z=77");
    for (int i = 0; i < 1000; i++) {
        for (unsigned axis = 0; axis < 4; axis++) {
            int32_t counts = rand() % 200000001 - 100000000;

            CHECK_INT(coordinates_user_to_counts(axis, coordinates_counts_to_user(axis, counts)),
                      counts);
            CHECK_INT(coordinates_mm_to_counts(axis, coordinates_counts_to_mm(axis, counts)),
                      counts);
        }
    }
}

TEST(places_out_of_range_are_clipped)
{
    closed_loop_start(NULL);
    CHECK_INT(coordinates_user_to_counts(0, 1e300), COORDINATES_COUNTS_MAX);
    CHECK_INT(coordinates_user_to_counts(0, -1e300), -COORDINATES_COUNTS_MAX);
    CHECK_INT(coordinates_mm_to_counts(0, (double)NAN), -COORDINATES_COUNTS_MAX);
}

/* The examples of the command reference, at 181590.4 counts/mm. */
TEST(relative_moves_round_their_distance_to_counts)
{
    int32_t before;

    closed_loop_start(NULL);
    SEND("C X=181590.4");
    CHECK_INT(coordinates_distance_to_counts(0, 10), 182);
    CHECK_INT(coordinates_distance_to_counts(0, 20), 363);
    CHECK_INT(coordinates_distance_to_counts(0, -10), -182);
    before = motion_target_counts(0);
    for (int i = 0; i < 20; i++) {
        SEND("R X=10");
        CHECK(closed_loop_wait(50000) >= 0);
    }
    CHECK_INT(motion_target_counts(0) - before, 20 * 182);
}

TEST(a_negative_multiplier_mirrors_the_axis)
{
    closed_loop_start(NULL);
    SEND("UM X=-10000 Y=10000");
    SEND("M X=1000 Y=1000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), -4540);
    CHECK_INT(motion_target_counts(1), 4540);
    CHECK_TEXT(closed_loop_send("W X Y"), ":A 1000.1 1000.1 \r\n");
    SEND("R X=-1000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 0);
    /* What is read as a place is the same place as a number of mm. */
    CHECK_INT(coordinates_mm_to_counts(0, 0.1), -4540);
    CHECK(coordinates_mirrored(0) && !coordinates_mirrored(1));
}

TEST(here_names_a_place_exactly)
{
    closed_loop_start(NULL);
    SEND("M X=777 Y=-333");
    CHECK(closed_loop_wait(50000) >= 0);
    SEND("HERE X=1234.5 Y=432.1 Z");
    CHECK_TEXT(closed_loop_send("W X Y Z"), ":A 1234.5 432.1 0.0 \r\n");
    SEND("M X=1234.5");
    CHECK_TEXT(closed_loop_send("/"), "B\r\n");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 3527);
    SEND("Z");
    CHECK_TEXT(closed_loop_send("W Z Y X"), ":A 0.0 0.0 0.0 \r\n");
    SEND("UM X=-10000");
    SEND("H X=500");
    CHECK_TEXT(closed_loop_send("W X"), ":A 500.0 \r\n");
}

TEST(a_multiplier_of_zero_is_refused)
{
    closed_loop_start(NULL);
    CHECK_TEXT(closed_loop_send("UM X=0"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("UM X=1e-7"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("UM X"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("UM X? Y?"), ":X=10000.000000 Y=10000.000000 A\r\n");
}

TEST(moves_end_at_the_soft_limits)
{
    closed_loop_start(NULL);
    SEND("SU X=1");
    SEND("SL X=-0.5");
    SEND("M X=30000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 45396);
    CHECK_TEXT(closed_loop_send("RS X-"), ":A U\r\n");
    SEND("R X=-90000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), -22698);
    CHECK_TEXT(closed_loop_send("RS X-"), ":A L\r\n");
}

/* Every way to go further out, and that it stands. The log says which limit it was, or nothing. */
#define CHECK_STAYS(line, fault)                                                                   \
    do {                                                                                           \
        const int32_t before = motion_target_counts(0);                                            \
                                                                                                   \
        fault_clear();                                                                             \
        SEND(line);                                                                                \
        closed_loop_run(500);                                                                      \
        CHECK_INT(motion_target_counts(0), before);                                                \
        CHECK_INT(fault_read(0), fault);                                                           \
    } while (0)

/* For instance when a limit was set behind it. */
TEST(a_move_from_outside_a_limit_never_goes_the_other_way_than_asked)
{
    closed_loop_start(NULL);
    SEND("M X=50000");
    CHECK(closed_loop_wait(50000) >= 0);
    SEND("SU X=3");
    CHECK_STAYS("R X=100", FAULT_LIMIT_UPPER);
    CHECK_STAYS("M X=70000", FAULT_LIMIT_UPPER);
    CHECK_STAYS("VE X=0.5", FAULT_NONE);
    CHECK_STAYS("! X", FAULT_NONE);
    SEND("OS X=0.1");
    CHECK_STAYS("R X=100", FAULT_LIMIT_UPPER);
    SEND("OS X=0");
    /* Back by just what was asked, though that is still outside. */
    SEND("R X=-10000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 4 * 45396);
    CHECK_STAYS("R X=10000", FAULT_LIMIT_UPPER);
    SEND("M X=10000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 45396);
    SEND("M X=40000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 3 * 45396);
    /* The same at the other end, of a mirrored axis. */
    SEND("UM X=-10000");
    SEND("SL X=-1");
    CHECK_STAYS("R X=-100", FAULT_LIMIT_LOWER);
    SEND("R X=10000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 2 * 45396);
}

TEST(limits_keep_their_place_when_the_origin_moves)
{
    closed_loop_start(NULL);
    SEND("SU X=2");
    SEND("M X=10000");
    CHECK(closed_loop_wait(50000) >= 0);
    SEND("H X=0");
    CHECK_TEXT(closed_loop_send("SU X?"), ":A X=1.000\r\n");
    SEND("M X=20000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 90792);
}

TEST(limits_are_those_of_the_mirrored_axis)
{
    closed_loop_start(NULL);
    SEND("UM X=-10000");
    CHECK_TEXT(closed_loop_send("SL X?"), ":A X=-110.000\r\n");
    SEND("SL X=-1");
    SEND("SU X=3");
    CHECK_TEXT(closed_loop_send("SL X?"), ":A X=-1.000\r\n");
    SEND("M X=-50000");
    CHECK(closed_loop_wait(50000) >= 0);
    CHECK_INT(motion_target_counts(0), 45396);
    CHECK(limits_allow(0, -3 * 45396) && !limits_allow(0, -3 * 45396 - 1));
}

TEST(a_limit_beyond_the_other_is_ignored)
{
    closed_loop_start(NULL);
    SEND("SU X=1");
    SEND("SL X=2");
    CHECK_TEXT(closed_loop_send("SL X? Y?"), ":A X=-110.000 Y=-110.000\r\n");
    SEND("SL X+");
    CHECK_TEXT(closed_loop_send("SL X?"), ":A X=0.000\r\n");
    SEND("SL X-");
    CHECK_TEXT(closed_loop_send("SL X?"), ":A X=-110.000\r\n");
}

/* What comes after a start is the same place of the stage, whichever way round a host had it. */
TEST(limits_and_home_keep_their_end_of_the_stage_at_a_start)
{
    closed_loop_start(NULL);
    SEND("UM X=-10000");
    SEND("SL X=-5");
    SEND("SU X=2");
    SEND("HM X=1.5");
    rig_start();
    CHECK_TEXT(closed_loop_send("UM X?"), ":X=10000.000000 A\r\n");
    CHECK_TEXT(closed_loop_send("SL X?"), ":A X=-2.000\r\n");
    CHECK_TEXT(closed_loop_send("SU X?"), ":A X=5.000\r\n");
    CHECK_TEXT(closed_loop_send("HM X?"), ":A X=-1.500\r\n");
    SEND("UM X=-10000");
    SEND("SS Z");
    rig_start();
    CHECK_TEXT(closed_loop_send("SL X?"), ":A X=-5.000\r\n");
    CHECK_TEXT(closed_loop_send("SU X?"), ":A X=2.000\r\n");
    CHECK_TEXT(closed_loop_send("HM X?"), ":A X=1.500\r\n");
}

/* Both beyond the default of one; and one that was ignored does not come back. */
TEST(limits_are_loaded_together)
{
    closed_loop_start(NULL);
    SEND("SL X=130");
    SEND("SU X=200");
    SEND("SL Y=-300");
    SEND("SU Y=-200");
    rig_start();
    CHECK_TEXT(closed_loop_send("SL X? Y?"), ":A X=-110.000 Y=-300.000\r\n");
    CHECK_TEXT(closed_loop_send("SU X? Y?"), ":A X=200.000 Y=-200.000\r\n");
    SEND("SL X=150");
    rig_start();
    CHECK_TEXT(closed_loop_send("SL X?"), ":A X=150.000\r\n");
}

TEST(default_limits_are_in_mm_of_the_saved_scale)
{
    closed_loop_start(NULL);
    SEND("C X=181590.4");
    SEND("SS Z");
    rig_start();
    CHECK_TEXT(closed_loop_send("SL X?"), ":A X=-110.000\r\n");
    CHECK_TEXT(closed_loop_send("SU X?"), ":A X=110.000\r\n");
}

TEST(a_name_beyond_the_counts_is_refused)
{
    closed_loop_start(NULL);
    SEND("Z");
    CHECK_TEXT(closed_loop_send("H X=1e300"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("H Y=5 X=-3e8"), ":N-4\r\n"); /* 30 m */
    CHECK_TEXT(closed_loop_send("W X Y"), ":A 0.0 0.0 \r\n");
    CHECK_TEXT(closed_loop_send("H X=2e8"), ":A \r\n");
    CHECK_TEXT(closed_loop_send("W X"), ":A 200000000.0 \r\n");
}

TEST_MAIN(RUN(a_name_beyond_the_counts_is_refused); RUN(a_place_is_the_nearest_count);
          RUN(counts_and_user_units_are_inverse);
          RUN(places_out_of_range_are_clipped);
          RUN(relative_moves_round_their_distance_to_counts);
          RUN(a_negative_multiplier_mirrors_the_axis);
          RUN(here_names_a_place_exactly);
          RUN(a_multiplier_of_zero_is_refused);
          RUN(moves_end_at_the_soft_limits);
          RUN(a_move_from_outside_a_limit_never_goes_the_other_way_than_asked);
          RUN(limits_keep_their_place_when_the_origin_moves);
          RUN(limits_are_those_of_the_mirrored_axis);
          RUN(a_limit_beyond_the_other_is_ignored);
          RUN(limits_and_home_keep_their_end_of_the_stage_at_a_start);
          RUN(limits_are_loaded_together);
          RUN(default_limits_are_in_mm_of_the_saved_scale))
