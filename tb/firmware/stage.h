/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * A perfect stage under the real firmware, for tests of what moves: axes follow their set-points
 * exactly, one count after the other, and the registers of the scan line are modelled from their
 * contract (not from the gateware): an edge, a direction, floor(k * N + phi).
 *
 * Line records say what the pins would have shown.
 */
#ifndef TB_FIRMWARE_STAGE_H
#define TB_FIRMWARE_STAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/axis.h"

enum { STAGE_LINES = 64, STAGE_PIXELS = 4096 };

/** One active line, as it would be seen at the pins. */
struct stage_line {
    unsigned sync_axis, encoder_axis;
    bool reverse;
    bool emit;                 /* pixels gave pulses */
    bool finished;             /* the last pixel came; else the line was cut short */
    int32_t sync_edge;         /* absolute edge at which SYNC rose */
    uint32_t pixels;           /* so far */
    uint32_t width_fast;
    int32_t pixel_edge[STAGE_PIXELS];
    int32_t at[AXIS_COUNT];    /* positions of all axes when SYNC rose */
};

extern struct stage_line stage_lines[STAGE_LINES];
extern unsigned stage_line_count;
extern int32_t stage_position[AXIS_COUNT]; /* counts */
extern bool stage_sync;                    /* SYNC pin, before polarity */

/** Faults to inject; cleared by stage_start. */
extern int32_t stage_end_error; /* counts by which the end position is reported wrong */
extern uint32_t stage_merged;   /* pulses of a line reported as merged */
extern unsigned stage_silent;   /* mask of axes whose encoder no longer counts */
extern bool stage_estop;

/** Power up: registers, axes at 0, settings, all modules, a console on test ports (port.h). */
void stage_start(void);

/** 200 us of servo ticks and one turn of the main loop, without the console. */
void stage_tick(void);

/** Ticks until STATUS would say N, at most `limit`; how many it took, or -1. */
int stage_run(int limit);

#endif
