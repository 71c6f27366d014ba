/* SPDX-License-Identifier: BSD-2-Clause */
/** The one list of modules, and the one list of who gets buttons and bare commands. */
#ifndef MODULES_MODULES_H
#define MODULES_MODULES_H

#include "core/action.h"
#include "core/module.h"

extern const struct module *const firmware_modules[]; /* ended by NULL */
extern const struct claim firmware_claims[];          /* ended by { 0 }; first come, first asked */

#endif
