/* SPDX-License-Identifier: BSD-2-Clause */
/* Gains in other words, on the board: AALIGN and DACK. */
#include "check.h"

#include <math.h>
#include <stdlib.h>

#include "closed_loop.h"
#include "modules/axis.h"

#define DONE ":A \r\n"
#define SEND(line) CHECK_TEXT(closed_loop_send(line), DONE)

/* How far a jolt takes the axis off a constant speed, counts. */
static double give(const char *strength)
{
    double most = 0;

    closed_loop_start(NULL);
    if (strcmp(closed_loop_send(strength), DONE) != 0 ||
        strcmp(closed_loop_send("M X=40000"), DONE) != 0)
        return -1;
    closed_loop_run(1000);
    closed_loop_push(0, 0.1);
    for (int n = 0; n < 100; n++) {
        struct axis_view view;

        closed_loop_tick();
        axis_read(0, &view);
        most = fmax(most, fabs((double)view.error_counts));
    }
    closed_loop_push(0, 0);
    return closed_loop_wait(50000) < 0 || board_count(closed_loop_board(), 0) != 181584 ? -1 : most;
}

TEST(aalign_is_the_strength_against_errors)
{
    double weakest = give("AA X=0"), middle = give("AA X=50"), full = give("AA X=85"),
           most = give("AA X=99");

    CHECK(weakest > 2 * full && middle > 1.3 * full && full > 1.05 * most && most > 1);
    closed_loop_start(NULL);
    SEND("AA X=83 Y=78 Z=59");
    CHECK_TEXT(closed_loop_send("AA Z? X? Y?"), ":A X=83 Y=78 Z=59\r\n");
    CHECK_TEXT(closed_loop_send("AA x "), ":N-3\r\n");
    CHECK_TEXT(closed_loop_send("AA X=0 Z"), ":N-3\r\n");
    CHECK_TEXT(closed_loop_send("AA X?"), ":A X=83\r\n");
    CHECK_TEXT(closed_loop_send("AA X=100"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("AA X=-1"), ":N-4\r\n");
    SEND("AA X=85 Y=85 Z=85");
    CHECK_TEXT(closed_loop_send("KP X?"), ":A X=800\r\n");
}

TEST(dack_is_the_speed_of_the_motor)
{
    closed_loop_start(NULL);
    /* 7.48 / 0.9 mm/s at full drive without friction. */
    CHECK_TEXT(closed_loop_send("D X?"), ":X=0.06494 A\r\n");
    SEND("D X=0.13");
    CHECK_TEXT(closed_loop_send("KV X?"), ":A X=53\r\n");
    CHECK_TEXT(closed_loop_send("D X=0"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("D X=1000"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("D X=1e-8"), ":N-4\r\n");
    CHECK_TEXT(closed_loop_send("KV X?"), ":A X=53\r\n");
}

TEST_MAIN(RUN(aalign_is_the_strength_against_errors); RUN(dack_is_the_speed_of_the_motor))
