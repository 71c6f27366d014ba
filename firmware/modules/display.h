/* SPDX-License-Identifier: BSD-2-Clause */
/** What a display has to show on behalf of the host: LCD, UNITS. No board has a display yet. */
#ifndef MODULES_DISPLAY_H
#define MODULES_DISPLAY_H

#include "core/module.h"

enum { DISPLAY_COLUMNS = 20 };

extern const struct module display_module;

/** The host's line, zero-ended, at most DISPLAY_COLUMNS characters; "": none. */
const char *display_text(void);

/** Positions in inches, not in mm. */
bool display_inches(void);

#endif
