/* SPDX-License-Identifier: BSD-2-Clause */
/** The SCAN commands: what a scan is made of, and its start and stop. The work is in scan_run.h. */
#ifndef MODULES_SCAN_H
#define MODULES_SCAN_H

#include <stdbool.h>

#include "core/module.h"

extern const struct module scan_module;

/** Start a scan as it is set, when none runs (TTL X=6). False: none was started. */
bool scan_start(void);

/** Claims of the @ button: long starts a scan, short ends one. */
bool scan_button_start(void);
bool scan_button_stop(void);

#endif
