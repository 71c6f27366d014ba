/* SPDX-License-Identifier: BSD-2-Clause */
/** What OUT0 shows: TTL Y and F, and the length of its pulses, RTIME Y. */
#ifndef MODULES_TTL_OUT_H
#define MODULES_TTL_OUT_H

#include "core/module.h"

extern const struct module ttl_out_module;

/* Modes, for the table in ttl_modes.c. */
void ttl_out_low(void);
void ttl_out_high(void);
void ttl_out_end_pulse(void);
bool ttl_out_at_constant_speed(unsigned axis);

/** Turn the level of OUT0 round, until its mode says another. */
void ttl_out_toggle(void);

#endif
