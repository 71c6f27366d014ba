/* SPDX-License-Identifier: BSD-2-Clause */
/** The SCAN commands: what a scan is made of, and its start and stop. The work is in scan_run.h. */
#ifndef MODULES_SCAN_H
#define MODULES_SCAN_H

#include <stdbool.h>

#include "core/module.h"

extern const struct module scan_module;

/** Start a scan as it is set, or end the one that runs: the @ button. False: nothing done. */
bool scan_start(void);
bool scan_stop(void);

/** A scan runs. */
bool scan_running(void);

/** A trigger (TTL X=6): start one when none runs. */
void scan_trigger(void);

#endif
