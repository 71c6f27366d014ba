/* SPDX-License-Identifier: BSD-2-Clause */
/* Scans that are begun without a line: by an edge at IN0 (TTL X=6) and by the @ button. */
#include "check.h"

#include "core/action.h"
#include "core/events.h"
#include "core/fault.h"
#include "port.h"
#include "scan_check.h"
#include "stage.h"

static void trigger(void)
{
    events_publish(EVENT_TRIGGER_IN, 1, events_now());
    events_publish(EVENT_TRIGGER_IN, 0, events_now());
    stage_tick();
}

TEST(an_edge_starts_a_scan_when_none_runs)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("TTL X=6", ACKNOWLEDGED);
    SEND("TTL X?", ":A X=6\r\n");
    trigger();
    SEND("/", "B\r\n");
    CHECK(!stage_sync);
    for (int n = 0; n < 5000 && !stage_sync; n++)
        stage_tick();
    trigger(); /* not again */
    CHECK(stage_run(200000) > 0);
    CHECK_INT(stage_line_count, 1);
    CHECK(stage_lines[0].emit && pixels_lie_on(&stage_lines[0], 1891, 24000));
    trigger();
    CHECK(stage_run(200000) > 0);
    CHECK_INT(stage_line_count, 2);
    SEND("TTL X=0", ACKNOWLEDGED);
    trigger();
    SEND("/", "N\r\n");
}

TEST(an_edge_in_a_scan_goes_to_no_point_of_the_ring_buffer)
{
    stage_start();
    WORKED_EXAMPLE; /* TTL X=1 */
    SEND("LD Z=100", ACKNOWLEDGED);
    SEND("LD Z=200", ACKNOWLEDGED);
    SEND("RM Y=7", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    trigger();
    CHECK(stage_run(200000) > 0);
    SEND("RM Z?", ":A Z=0\r\n");
    CHECK_INT(stage_position[2], 0);
    CHECK(stage_lines[0].emit && pixels_lie_on(&stage_lines[0], 1891, 24000));
    trigger();
    CHECK(stage_run(200000) > 0);
    SEND("RM Z?", ":A Z=1\r\n");
    CHECK_INT(stage_position[2], 454);
}

TEST(a_point_that_a_scan_keeps_it_from_stays_the_next)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("BU F=1", ACKNOWLEDGED); /* IN0_INT: the ring buffer, also in a scan */
    SEND("LD X=100", ACKNOWLEDGED);
    SEND("LD X=200", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    trigger();
    SEND("RM Z?", ":A Z=0\r\n");
    CHECK(stage_run(200000) > 0);
    CHECK(stage_lines[0].finished && !stage_lines[0].emit);
    trigger();
    SEND("RM Z?", ":A Z=1\r\n");
}

TEST(a_scan_that_cannot_be_is_not_started)
{
    stage_start();
    SEND("TTL X=6", ACKNOWLEDGED);
    trigger(); /* start is stop after power-up */
    SEND("/", "N\r\n");
    CHECK(!action_perform(ACTION_AT_LONG));
    WORKED_EXAMPLE;
    SEND("MC X-", ACKNOWLEDGED);
    CHECK(!action_perform(ACTION_AT_LONG));
    SEND("/", "N\r\n");
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST(the_at_button_starts_a_scan_and_ends_it)
{
    stage_start();
    WORKED_EXAMPLE;
    CHECK(!action_perform(ACTION_AT_SHORT)); /* no scan and no point to go to */
    CHECK(action_perform(ACTION_AT_LONG));
    for (int n = 0; n < 5000 && !stage_sync; n++)
        stage_tick();
    CHECK(stage_sync);
    CHECK(!action_perform(ACTION_AT_LONG));
    CHECK(action_perform(ACTION_AT_SHORT));
    CHECK(stage_run(200000) >= 0);
    SEND("SCAN X?", ":A I\r\n");
    CHECK(!stage_lines[0].finished);
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST_MAIN(RUN(an_edge_starts_a_scan_when_none_runs);
          RUN(an_edge_in_a_scan_goes_to_no_point_of_the_ring_buffer); RUN(a_point_that_a_scan_keeps_it_from_stays_the_next);
          RUN(a_scan_that_cannot_be_is_not_started);
          RUN(the_at_button_starts_a_scan_and_ends_it))
