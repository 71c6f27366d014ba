/* SPDX-License-Identifier: BSD-2-Clause */
/** The SCAN commands: what a scan is made of, and its start and stop. The work is in scan_run.h. */
#ifndef MODULES_SCAN_H
#define MODULES_SCAN_H

#include "core/module.h"

extern const struct module scan_module;

#endif
