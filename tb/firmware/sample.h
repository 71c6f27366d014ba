/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * A module that uses every service of core/, as an example and as the proof that a module is one
 * file and one line in a list. It steers a made-up lamp on each axis.
 */
#ifndef TB_FIRMWARE_SAMPLE_H
#define TB_FIRMWARE_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "core/action.h"
#include "core/module.h"

extern const struct module sample_module;
extern const struct module *const sample_modules[]; /* the list with this module alone */

bool sample_take_button(void); /* claim of ACTION_AT_SHORT; takes it while the lamp is lit */

/* What the tests look at. */
extern double sample_level_percent[AXIS_COUNT];
extern bool sample_lit;
extern unsigned sample_sets, sample_ticks, sample_faults, sample_urgent, sample_inits;
extern uint32_t sample_last_argument;
extern uint64_t sample_last_time;

#endif
