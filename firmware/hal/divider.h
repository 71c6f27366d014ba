/* SPDX-License-Identifier: BSD-2-Clause */
/** Pixel clock: one pulse every N edges of an active line. Armed by hal/compare.h. */
#ifndef HAL_DIVIDER_H
#define HAL_DIVIDER_H

#include <stdbool.h>
#include <stdint.h>

/** A line, as it is taken at arming; the pulse width also at each pulse. */
struct divider_line {
    unsigned axis;              /* whose edges are counted */
    uint32_t whole, fraction;   /* edges per pixel: whole + fraction / 2^32, at least 1 */
    uint32_t phase;             /* pixel k comes at edge floor(k * N + phase / 2^32) */
    uint32_t pixels;            /* at least 1 */
    uint32_t width_fast;        /* pulse, fast clocks, 1 to 2^24 - 1 */
    uint32_t interval_min_fast; /* pixels come no closer than this at maximum speed */
    bool emit;                  /* pulses; without, pixels are counted only */
};

/** What became of the last line. Values latched by the gateware; read when the line has ended. */
struct divider_result {
    bool refused;        /* the arming was refused: a setting out of range, or pulses would merge */
    bool merged;         /* pixels came while the pulse before was still high */
    uint32_t produced;   /* pixels, with or without a pulse */
    uint32_t merged_pixels;
    int32_t end_counts;  /* position at the last pixel */
};

/** Load a line; it is armed with compare_arm. */
void divider_load(const struct divider_line *line);

void divider_read(struct divider_result *result);

#endif
