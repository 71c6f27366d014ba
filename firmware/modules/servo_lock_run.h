/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The servo lock at work: the tick interrupt takes the decisions of rtl/decisions.py and moves the set-points; the
 * main loop begins and ends it. What it is set to, and the commands, are servo_lock.c's.
 *
 * HALT, a limit switch, MC-, the emergency stop, a fault: whatever stops one of its axes ends it for all.
 */
#ifndef MODULES_SERVO_LOCK_RUN_H
#define MODULES_SERVO_LOCK_RUN_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/classifier.h"

/** Pulses since it was engaged. */
struct servo_lock_counts {
    uint32_t pulses;
    uint32_t clipped; /* of them, those that the range cut short, on one axis or more */
    uint32_t lost;    /* came faster than they could be taken */
};

/**
 * Take the axes of RBMODE Y, fenced to `range_mm` either way and to the soft limits, and the input IN0.
 * True too when it is engaged already. False: the axes cannot be had, or it is still ending.
 */
bool servo_lock_engage(const struct classifier_settings *pulse, double range_mm);

/** End it. Pulses that ended before this still count: a few ticks later it is over. */
void servo_lock_leave(void);

/** How pulses are judged from now on. Nothing when it is not engaged. */
void servo_lock_configure(const struct classifier_settings *pulse);

/** The steps of MOVREL are others now. */
void servo_lock_steps_changed(void);

bool servo_lock_engaged(void);

/** It is engaged and an axis is one that responds. */
bool servo_lock_has(unsigned axis);

struct servo_lock_counts servo_lock_counts(void);

void servo_lock_poll(void);
void servo_lock_init(void);

#endif
