/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The geometry of a scan line: from what the user set to what the gateware counts.
 *
 * Pure arithmetic, no state, no hardware. An *edge* e is the boundary between counts e-1 and e; the
 * compare and the divider work on edges, so that a boundary between pixels is the same place of the
 * stage in both directions.
 *
 * Whatever decides a number of pixels or an edge is integer arithmetic on millionths (nanometres,
 * millionths of a count): the resolution in which these settings are printed, so that what is read
 * back is what is used.
 */
#ifndef MODULES_SCAN_PLAN_H
#define MODULES_SCAN_PLAN_H

#include <stdbool.h>
#include <stdint.h>

/* Longest pixel pulse the divider can make: its Width register has 24 bits. */
#define SCAN_PLAN_WIDTH_MAX 0xFFFFFFu

/* Least way, in counts, between the place where the compare is armed and the reference edge: more
 * than the stage moves while it holds still. A slow line has a run-up because of it. */
#define SCAN_PLAN_MARGIN_COUNTS 16

/** What a scan is made of, in the user's units. */
struct scan_settings {
    double start_mm, stop_mm;     /* of the fast axis, user coordinates */
    uint32_t pixels;              /* from start toward stop; 0: as many as fit between them */
    double pitch_counts;          /* counts per pixel, may have a fraction */
    double width_us;              /* of a pulse; 0: half a pixel at line speed, at most 10 us */
    double settle_ms;             /* at constant speed, before the reference and after the end */
    double overshoot_mm;          /* added to the run-up and to the overrun */
};

/** The fast axis, as it is when the scan starts. */
struct scan_axis {
    double counts_per_mm;         /* > 0 */
    double speed_mm_per_s;        /* of the line, > 0 */
    double speed_max_mm_per_s;    /* of the axis, >= speed_mm_per_s */
    double accel_ms;              /* from rest to the line speed */
    int32_t start_count;          /* the count nearest to start_mm */
    bool mirrored;                /* a growing user coordinate is a falling count */
    uint32_t fast_clock_hz;
};

/**
 * One active line. The forward line runs from start toward stop, the return line back over the same
 * edges.
 */
struct scan_line {
    int32_t reference_edge;       /* SYNC rises when it is crossed in the direction of the line */
    bool reverse;                 /* the count falls along the line */
    uint32_t phase;               /* of the divider, in 2^-32 of a count */
    int32_t end_count;            /* the count just after the last pixel's edge */
    int32_t from_count;           /* where the stage stands still before the line */
    int32_t to_count;             /* where it stands still after the line */
};

struct scan_plan {
    struct scan_line forward, back;
    uint32_t pixels;
    uint32_t pitch_whole, pitch_fraction; /* counts per pixel; fraction in 2^-32, rounded down */
    uint32_t width_fast;                  /* pixel pulse, fast clocks */
    uint32_t interval_min_fast;           /* between pixels at the maximum speed, fast clocks */
};

enum scan_plan_status {
    SCAN_PLAN_OK,
    SCAN_PLAN_NO_LENGTH,     /* start and stop are the same place */
    SCAN_PLAN_PITCH,         /* less than one count per pixel, or more than a line can hold */
    SCAN_PLAN_NO_PIXELS,     /* the line is shorter than one pixel */
    SCAN_PLAN_SPEED,         /* the line speed is not a positive number */
    SCAN_PLAN_RANGE,         /* an edge of the line lies outside the 32-bit counts */
    SCAN_PLAN_WIDTH,         /* pulses of this width would leave less than 2 clocks between them */
};

/**
 * Plan the lines of a scan.
 *
 * pixels = floor(counts_per_mm * |stop - start| / pitch), exactly. Pixel k of the forward line
 * falls on the edge ceil(k * pitch) after the reference edge; the return line starts at the last of
 * these edges and its pixels fall on the same ones in reverse order, the last on the forward line's
 * reference edge.
 *
 * @param plan  Written only when the answer is SCAN_PLAN_OK.
 */
enum scan_plan_status scan_plan_make(const struct scan_settings *settings,
                                     const struct scan_axis *axis, struct scan_plan *plan);

/**
 * Pixels that fit between start and stop, or the number that was set; what SCANR F? answers.
 *
 * @return  0 when the settings make no line.
 */
uint32_t scan_plan_pixels(const struct scan_settings *settings, double counts_per_mm);

/** End of the line as set, in mm: stop, or start and so many pixels when their number was set. */
double scan_plan_stop_mm(const struct scan_settings *settings, double counts_per_mm);

/** Position of slow line `line` (0 is the first) of `lines`: the end point is not one of them. */
double scan_plan_slow_mm(double start_mm, double stop_mm, uint32_t lines, uint32_t line);

#endif
