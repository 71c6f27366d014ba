/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * SERVOLOCK_TTL: pulses at IN0 move the target of a regulated stage by steps, short ones up and long
 * ones down. LOCK (LK), LOCKRG Z, RTIME R.
 *
 * Engaged, the axes of RBMODE Y are this module's. Settings and commands; servo_lock_run.c does the work.
 */
#ifndef MODULES_SERVO_LOCK_H
#define MODULES_SERVO_LOCK_H

#include "core/module.h"

extern const struct module servo_lock_module;

/** Bare LK: engage, or disengage. False: the axes cannot be had. */
bool servo_lock_toggle(void);

#endif
