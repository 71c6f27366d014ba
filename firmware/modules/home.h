/* SPDX-License-Identifier: BSD-2-Clause */
/** HOME and where it goes to: SETHOME. */
#ifndef MODULES_HOME_H
#define MODULES_HOME_H

#include <stdbool.h>

#include "core/module.h"

extern const struct module home_module;

/** Keep the home of all axes in the settings store as it is now (SAVEPOS). False: not kept. */
bool home_keep(void);

#endif
