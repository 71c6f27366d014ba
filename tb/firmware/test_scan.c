/* SPDX-License-Identifier: BSD-2-Clause */
/* Scans over a perfect stage: what the pins would have shown, line by line. */
#include "scan_check.h"

#include <math.h>
#include <stdlib.h>

TEST(worked_example_makes_1891_pixels)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    SEND("/", "B\r\n");
    CHECK_TEXT(states(), "SabcdefI");
    SEND("/", "N\r\n");
    CHECK_INT(stage_line_count, 1);
    CHECK_INT(stage_lines[0].sync_edge, 0);
    CHECK(!stage_lines[0].reverse);
    CHECK(stage_lines[0].emit);
    CHECK(pixels_lie_on(&stage_lines[0], 1891, 24000));
    CHECK_INT(stage_lines[0].width_fast, 2000); /* 10 us */
    CHECK_INT(fault_read(0), FAULT_NONE);
    CHECK(!stage_sync);
    /* It stays where the overrun ended: ramp (25 ms) and settling (10 ms) at 2.112 mm/s, margin. */
    CHECK_INT(stage_position[0], 1891 * 24 + (int)ceil(2.112 * 0.035 * 45396) + 16);
    CHECK_INT(stage_position[1], 0);
}

TEST(line_is_run_at_the_set_speed)
{
    int ticks = 0;

    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN", ACKNOWLEDGED);
    while (!stage_sync)
        stage_tick();
    while (stage_sync) {
        stage_tick();
        ticks++;
    }
    /* 45384 counts at 2.112 mm/s: 0.47337 s, 2367 ticks of 200 us. */
    CHECK(abs(ticks - 2367) <= 1);
}

TEST(without_the_encoder_interrupt_sync_comes_alone)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("TTL X=0", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdefI");
    CHECK_INT(stage_line_count, 1);
    CHECK(!stage_lines[0].emit);
    CHECK(stage_lines[0].finished);
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST(negative_direction_starts_when_the_start_count_is_reached_from_above)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANR X=0.5 Y=-0.5", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdefI");
    /* Count 22698 is made by crossing edge 22699 downward. */
    CHECK_INT(stage_lines[0].sync_edge, 22699);
    CHECK(stage_lines[0].reverse);
    CHECK(pixels_lie_on(&stage_lines[0], 1891, 24000));
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST(mirrored_axis_scans_the_same_line_the_other_way)
{
    stage_start();
    SEND("UM X=-10000 Y=10000", ACKNOWLEDGED);
    WORKED_EXAMPLE;
    SEND("SCANR X=0.1", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdefI");
    /* User 0.1 mm is count -4540 (4539.6); coming from above it is made by crossing edge -4539. */
    CHECK_INT(stage_lines[0].sync_edge, -4539);
    CHECK(stage_lines[0].reverse);
    CHECK(pixels_lie_on(&stage_lines[0], 1702, 24000));
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST(divides_of_several_kinds)
{
    static const struct {
        const char *command;
        uint32_t pixels;
        long long milli;
    } cases[] = {
        {"SCANR Z=38", 1194, 38000},
        {"SCANR Z=454", 99, 454000},
        {"SCANR Z=24.4", 1860, 24400},
        {"SCANR Z=24.6", 1845, 24600},
        {"SCANR Z=24 F=100", 100, 24000},
    };

    for (size_t n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        stage_start();
        WORKED_EXAMPLE;
        SEND(cases[n].command, ACKNOWLEDGED);
        SEND("SCAN", ACKNOWLEDGED);
        CHECK(stage_run(200000) > 0);
        CHECK_INT(stage_line_count, 1);
        CHECK(pixels_lie_on(&stage_lines[0], cases[n].pixels, cases[n].milli));
        CHECK_INT(fault_read(0), FAULT_NONE);
    }
}

TEST(fast_y_takes_sync_and_encoder_with_it)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCAN X=2 Y=1 Z=0 F=0", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdefI");
    CHECK_INT(stage_lines[0].sync_axis, 1);
    CHECK_INT(stage_lines[0].encoder_axis, 1);
    CHECK(pixels_lie_on(&stage_lines[0], 1891, 24000));
    CHECK_INT(stage_position[0], 0);
}

TEST(raster_repeats_the_same_edges_on_each_line)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANR Y=0.05 Z=24.4", ACKNOWLEDGED);
    SEND("SCANV X=0.1 Y=0.4 Z=3", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdefghcdefghcdefI");
    CHECK_INT(stage_line_count, 3);
    for (unsigned n = 0; n < 3; n++) {
        CHECK_INT(stage_lines[n].sync_edge, 0);
        CHECK(pixels_lie_on(&stage_lines[n], 93, 24400)); /* 2269.8 / 24.4 */
        /* Lines at X + i (Y - X) / Z, the end point excluded. */
        CHECK_INT(stage_lines[n].at[1], lround((0.1 + 0.1 * n) * 45396));
    }
    CHECK_INT(scan_run_lines_done(), 3);
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST(serpentine_returns_over_the_same_edges)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANR Y=0.0524 Z=24.4", ACKNOWLEDGED);
    SEND("SCANV X=0 Y=0.2 Z=4", ACKNOWLEDGED);
    SEND("SCAN F=1", ACKNOWLEDGED);
    SEND("SCAN X=83", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SabcdefhcdefhcdefhcdefI");
    CHECK_INT(stage_line_count, 4);
    for (unsigned n = 0; n < 4; n++) {
        const struct stage_line *forward = &stage_lines[0], *line = &stage_lines[n];

        CHECK(line->finished);
        CHECK_INT(line->pixels, 97);
        CHECK_INT(line->reverse, n % 2);
        CHECK_INT(line->at[1], lround(0.05 * n * 45396));
        if (n % 2 == 0) {
            CHECK(pixels_lie_on(line, 97, 24400));
            continue;
        }
        CHECK_INT(line->sync_edge, forward->pixel_edge[96]);
        for (int k = 0; k < 96; k++)
            CHECK_INT(line->pixel_edge[k], forward->pixel_edge[95 - k]);
        CHECK_INT(line->pixel_edge[96], forward->sync_edge);
    }
    CHECK_INT(fault_read(0), FAULT_NONE);
}

TEST(scan_without_a_slow_axis_repeats_the_line)
{
    stage_start();
    WORKED_EXAMPLE;
    SEND("SCANR Y=0.05", ACKNOWLEDGED);
    SEND("SCANV X=3 Y=4 Z=2", ACKNOWLEDGED);
    SEND("SCAN X=1 Y=0 Z=0", ACKNOWLEDGED);
    SEND("SCAN", ACKNOWLEDGED);
    CHECK_TEXT(states(), "SbcdefghcdefI");
    CHECK_INT(stage_line_count, 2);
    CHECK_INT(stage_position[1], 0);
}

TEST_MAIN(RUN(worked_example_makes_1891_pixels); RUN(line_is_run_at_the_set_speed);
          RUN(without_the_encoder_interrupt_sync_comes_alone);
          RUN(negative_direction_starts_when_the_start_count_is_reached_from_above);
          RUN(mirrored_axis_scans_the_same_line_the_other_way); RUN(divides_of_several_kinds);
          RUN(fast_y_takes_sync_and_encoder_with_it);
          RUN(raster_repeats_the_same_edges_on_each_line);
          RUN(serpentine_returns_over_the_same_edges);
          RUN(scan_without_a_slow_axis_repeats_the_line))
