/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The error log that DUMP Y prints: a ring of the last FAULT_LOG codes.
 *
 * One writer: log_error is for the main loop. Interrupts use log_error_from_interrupt, whose codes
 * fault_poll moves into the log. Each entry in the log is published as EVENT_FAULT.
 */
#ifndef CORE_FAULT_H
#define CORE_FAULT_H

#include <stdint.h>

enum { FAULT_LOG = 64 };

/** Codes of the original; "+ axis": add the axis number 0 to 3. */
enum fault {
    FAULT_NONE = 0,
    FAULT_OVERTIME = 1,               /* 1 to 9: the main loop took too long */
    FAULT_OVERSHOT = 10,              /* + axis: the move went past its target; routine */
    FAULT_AXIS_DEAD = 20,             /* + axis: no movement under drive; axis stopped */
    FAULT_ENCODER = 24,               /* illegal encoder transitions */
    FAULT_RUNAWAY = 30,               /* + axis: moves away from its target; axis stopped */
    FAULT_LIMIT_UPPER = 34,
    FAULT_LIMIT_LOWER = 35,
    FAULT_INTO_LIMIT_UPPER = 36,
    FAULT_INTO_LIMIT_LOWER = 37,
    FAULT_INTO = FAULT_INTO_LIMIT_UPPER - FAULT_LIMIT_UPPER,
    FAULT_FINISH_SPEED_CLAMP = 44,
    FAULT_TASK_OVERTIME = 48,         /* an event queue or the servo tick overran */
    FAULT_ENCODER_OVERFLOW = 50,      /* + axis: error term too large; axis stopped */
    FAULT_NOT_LOADED = 55,            /* settings that were kept could not be loaded, all or some */
    FAULT_ADJUST_MOVE = 60,           /* + axis: could not hold the target */
    FAULT_SCAN_LOST_PULSES = 85,
    FAULT_SCAN_INCOMPLETE = 86,
    FAULT_REPORT_OVERRUN = 87,
    FAULT_ERROR_LARGE = 90,           /* + axis: full speed to catch up */
    FAULT_INDEX_NOT_FOUND = 100,      /* + axis */
    FAULT_TEN_MINUTES = 255,          /* a time mark, no error */
};

void log_error(uint16_t code);
void log_error_from_interrupt(uint16_t code);
void fault_poll(void);

/** Entry 0 (the newest) to FAULT_LOG - 1; FAULT_NONE: an empty slot. */
uint16_t fault_read(unsigned entry);
void fault_clear(void);

#endif
