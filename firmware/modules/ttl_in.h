/* SPDX-License-Identifier: BSD-2-Clause */
/** What a rising edge at IN0 does: TTL X, the profile (BUILD F), timed reports and repeated moves. */
#ifndef MODULES_TTL_IN_H
#define MODULES_TTL_IN_H

#include "core/module.h"

extern const struct module ttl_in_module;

/** Do what a pulse at IN0 does in the present mode: bare RM. Always true. */
bool ttl_in_trigger(void);

/**
 * A module takes the input for a mode of its own, whatever TTL X says, and gives it back. TTL X?
 * then answers that mode; what is set meanwhile counts from ttl_in_restore on, unless the mode is one
 * that nobody else can set.
 *
 * @param number  A mode of the table.
 * @return        False: there is none in this profile (BUILD F), and nothing has changed.
 */
bool ttl_in_force(int number);
void ttl_in_restore(void);

/* Modes, for the table in ttl_modes.c. */
struct ttl_step;
bool ttl_in_repeat(struct ttl_step *step);
void ttl_in_report(void);
void ttl_in_report_end(void);

#endif
