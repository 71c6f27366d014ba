/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * SERVOLOCK_TTL: pulses at IN0 move the target of a regulated stage by steps, short ones up and long
 * ones down. LOCK (LK), LOCKRG Z, RTIME R.
 *
 * Engaged, the axes of RBMODE Y are this module's. rtl/decisions.py judges the pulses; each servo
 * tick takes the decisions and moves the set-points; the main loop only begins and ends it.
 */
#ifndef MODULES_SERVO_LOCK_H
#define MODULES_SERVO_LOCK_H

#include "core/module.h"

extern const struct module servo_lock_module;

/** Bare LK: engage, or disengage. False: the axes cannot be had. */
bool servo_lock_toggle(void);

/** It is engaged and an axis is one that responds. */
bool servo_lock_has(unsigned axis);

#endif
