/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Each pulse at IN0, or OUT0, sends the positions of all axes as they were at its edge:
 * TTL_REPORT_INT and TTL_OUT_REPORT, TTL M, TTLREPORT. docs/modules/ttl_report.md.
 */
#ifndef MODULES_TTL_REPORT_H
#define MODULES_TTL_REPORT_H

#include "core/module.h"

extern const struct module ttl_report_module;

/* For the table in ttl_modes.c. */
void ttl_report_begin(void);
void ttl_report_end(void);

/** The interrupts of the trigger and the report port. True: a turn of the main loop is due. */
bool ttl_report_interrupt(void);

#endif
