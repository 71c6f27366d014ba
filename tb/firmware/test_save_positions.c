/* SPDX-License-Identifier: BSD-2-Clause */
/* SAVEPOS, up to its acknowledge; what comes after a power cycle is in tb/transcripts. */
#include "check.h"

#include "machine.h"
#include "modules/motion.h"
#include "modules/save_positions.h"
#include "port.h"

/* Turns until the answer is there, ticks in between. */
static const char *shut_down(void)
{
    static char all[32];
    size_t length = 0;

    all[0] = '\0';
    port_hold();
    port_queue("SP\r");
    for (int n = 0; n < 5000 && strchr(all, '\n') == NULL; n++) {
        strcpy(all + length, port_take(10));
        length += strlen(all + length);
        if (length == 1 && motion_busy())
            return "an answer while it moves";
        machine_run(1);
    }
    return all;
}

TEST(stops_what_moves_before_it_answers)
{
    machine_start();
    machine_run(200);
    CHECK_TEXT(machine_send("M X=10000 Y=-10000"), ":A \r\n");
    machine_run(500);
    CHECK_TEXT(shut_down(), ":A \r\n");
    CHECK(save_positions_is_down());
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        CHECK(!motion_enabled(axis));
}

TEST(does_not_wait_for_an_axis_that_is_off)
{
    machine_start();
    machine_run(200);
    CHECK_TEXT(machine_send("MC X- Z-"), ":A \r\n");
    CHECK_TEXT(shut_down(), ":A \r\n");
    CHECK(save_positions_is_down());
}

TEST_MAIN(RUN(stops_what_moves_before_it_answers); RUN(does_not_wait_for_an_axis_that_is_off))
