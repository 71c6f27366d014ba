/* SPDX-License-Identifier: BSD-2-Clause */
/* Lines that go wrong: 85 when pulses are missing, 86 when the line is; and what counts as wrong. */
#include "scan_check.h"

#include "hal/compare.h"

TEST(sync_that_never_comes_is_error_85)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANV R=2", ACKNOWLEDGED); /* JP1 on Y, which stands before the edge for ever */
    SEND("SCANR X=0.1", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdEI");
    CHECK_INT(stage_line_count, 0);
    CHECK_INT(fault_read(0), FAULT_SCAN_LOST_PULSES);
    CHECK_INT(fault_read(1), FAULT_NONE);
}

TEST(arming_past_the_reference_is_error_85_and_does_not_run_the_line)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANV R=2", ACKNOWLEDGED); /* Y stands at 0: past an edge at -4540 */
    SEND("SCANR X=-0.1", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcEI");
    CHECK_INT(fault_read(0), FAULT_SCAN_LOST_PULSES);
    CHECK(stage_position[0] < -4540);
}

TEST(line_that_ends_before_its_pixels_is_error_86)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANV M=2", ACKNOWLEDGED); /* JP2 on Y, which stands still */
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdeEI");
    CHECK_INT(stage_line_count, 1);
    CHECK_INT(stage_lines[0].encoder_axis, 1);
    CHECK_INT(stage_lines[0].pixels, 0);
    CHECK(!stage_sync);
    CHECK_INT(fault_read(0), FAULT_SCAN_INCOMPLETE);
}

TEST(wrong_end_position_is_error_86)
{
    stage_start();
    WORKED_EXAMPLE;
    stage_end_error = -1;
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdeEI");
    CHECK_INT(fault_read(0), FAULT_SCAN_INCOMPLETE);
}

TEST(pulses_that_merge_are_error_85)
{
    stage_start();
    WORKED_EXAMPLE;
    stage_merged = 1;
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdeEI");
    CHECK_INT(fault_read(0), FAULT_SCAN_LOST_PULSES);
    CHECK_INT(fault_read(1), FAULT_NONE);
}

TEST(an_encoder_that_falls_silent_in_a_line_is_error_86)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    go_into_the_line();
    stage_silent = 1;
    CHECK_TEXT(states(), "eEI");
    CHECK_INT(fault_read(0), FAULT_SCAN_INCOMPLETE);
    CHECK_INT(fault_read(1), FAULT_AXIS_DEAD);
    CHECK(!stage_sync && !compare_status().armed);
    CHECK(!stage_lines[0].finished);
    SEND("RS X-", ":A D\r\n");
    SEND("/", "N\r\n");
}

TEST(an_encoder_that_falls_silent_before_its_line_is_error_85)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    while (scan_run_state() != SCAN_ACCELERATE)
        stage_tick();
    stage_silent = 1;
    CHECK_TEXT(states(), "dEI");
    CHECK_INT(fault_read(0), FAULT_SCAN_LOST_PULSES);
    CHECK_INT(stage_line_count, 0);
}

TEST(an_emergency_stop_or_an_end_that_was_asked_for_is_no_error_of_the_line)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    go_into_the_line();
    stage_estop = true;
    (void)states();
    CHECK_INT(fault_read(0), FAULT_NONE);
}

/* Any axis has the signals here; with the jumpers on X, or as the original is wired, Z has none. */
TEST(any_axis_scans_and_one_without_signals_is_an_error)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("S Z=2.112", ACKNOWLEDGED);
    SEND("SCAN X=2 Y=0 Z=1", ACKNOWLEDGED);
    SEND("SCANR Y=0.05", ACKNOWLEDGED);
    SEND("SCANV X=0 Y=0.2 Z=2", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdefghcdefI");
    CHECK_INT(stage_line_count, 2);
    CHECK_INT(stage_lines[1].sync_axis, 2);
    CHECK_INT(stage_lines[1].encoder_axis, 2);
    CHECK_INT(stage_lines[1].at[0], 4540); /* 0.1 mm */
    CHECK(pixels_lie_on(&stage_lines[1], 94, 24000));
    CHECK_INT(fault_read(0), FAULT_NONE);

    SEND("M X=-100", ACKNOWLEDGED); /* and Z a line of its own: X stands */
    SEND("SCAN X=0 Z=1", ACKNOWLEDGED);
    CHECK(stage_run(20000) > 0);
    SEND("SCANV R=1 M=1", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SbcdEI");
    CHECK_INT(fault_read(0), FAULT_SCAN_LOST_PULSES);
    SEND("SCANV R=0", ACKNOWLEDGED); /* SYNC of Z, pixels of X */
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SbcdeEI");
    CHECK_INT(fault_read(0), FAULT_SCAN_INCOMPLETE);
    SEND("SCANV M=0", ACKNOWLEDGED);
    SEND("SCAN C=1", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SbcdEI");
    CHECK_INT(fault_read(0), FAULT_SCAN_LOST_PULSES);
}

TEST_MAIN(RUN(sync_that_never_comes_is_error_85);
          RUN(arming_past_the_reference_is_error_85_and_does_not_run_the_line);
          RUN(line_that_ends_before_its_pixels_is_error_86); RUN(wrong_end_position_is_error_86);
          RUN(pulses_that_merge_are_error_85);
          RUN(an_encoder_that_falls_silent_in_a_line_is_error_86);
          RUN(an_encoder_that_falls_silent_before_its_line_is_error_85);
          RUN(an_emergency_stop_or_an_end_that_was_asked_for_is_no_error_of_the_line);
          RUN(any_axis_scans_and_one_without_signals_is_an_error))
