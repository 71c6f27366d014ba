/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Carrying out a scan: moves the axes from line to line, arms the gateware before each, and checks
 * what it reports.
 *
 * No edge of SYNC or ENCODER depends on when this code runs: it arms while the stage stands still
 * before a line, and reads the results after the line is over.
 */
#ifndef MODULES_SCAN_RUN_H
#define MODULES_SCAN_RUN_H

#include <stdbool.h>
#include <stdint.h>

#include "core/status.h"
#include "modules/scan_plan.h"

/** Axis number that means "no axis". */
#define SCAN_NO_AXIS (-1)

/**
 * All that a scan is started with, besides SPEED, ACCEL and CNTS; taken at the start, later changes
 * are for the next one.
 */
struct scan_setup {
    struct scan_settings line;           /* of the fast axis */
    int fast, slow;                      /* axis numbers, or SCAN_NO_AXIS */
    double slow_start_mm, slow_stop_mm;  /* first line, and the one after the last; user mm */
    uint32_t lines;                      /* at least 1 */
    double retrace_percent;              /* of the fast axis' maximum speed, between raster lines */
    bool serpentine;                     /* every other line runs back, nothing is retraced */
    int sync_axis, encoder_axis;         /* whose edges give SYNC, and pixels */
    bool pulses;                         /* pixels give pulses, not only SYNC */
};

/** The letters that SCAN X? answers. */
enum scan_state {
    SCAN_IDLE = 'I',
    SCAN_START = 'S',      /* accepted; the axes are being taken */
    SCAN_SLOW_FIRST = 'a', /* the slow axis goes to the first line */
    SCAN_RUN_UP = 'b',     /* the fast axis goes to where the line is begun from */
    SCAN_SETTLE = 'c',     /* both stand; the gateware is armed next */
    SCAN_ACCELERATE = 'd', /* toward the reference edge */
    SCAN_ACTIVE = 'e',     /* between SYNC and the last pixel */
    SCAN_OVERRUN = 'f',    /* slowing down behind the line */
    SCAN_RETRACE = 'g',    /* raster: back to where the next line is begun from */
    SCAN_SLOW_STEP = 'h',  /* the slow axis goes to the next line */
    SCAN_STOP = 'P',       /* asked to stop: both axes slow down */
    SCAN_ERROR = 'E',      /* a line failed and was logged: both axes slow down */
};

/**
 * Whether a scan could start like this, changing nothing.
 *
 * @return  STATUS_OK; STATUS_RANGE for settings that make no scan (no fast axis, the same axis
 *          twice, no length, less than a count per pixel, pulses that would merge, a way that
 *          leaves the travel); STATUS_FAILED when an axis does not take orders (disabled, or the
 *          emergency stop is pressed).
 */
enum status scan_run_check(const struct scan_setup *setup);

/** Start; the scan is busy from here on. Answers as scan_run_check, and then nothing has moved. */
enum status scan_run_start(const struct scan_setup *setup);

/** Stop: SYNC falls at once, the axes slow down, then idle. Nothing happens when idle. */
void scan_run_stop(void);

enum scan_state scan_run_state(void);

/** Lines completed since the start. */
uint32_t scan_run_lines_done(void);

/** Idle, whatever was going on: start-up and RESET, when the axes have been stopped by others. */
void scan_run_init(void);

/** One turn of the main loop. */
void scan_run_poll(void);

#endif
