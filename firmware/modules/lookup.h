/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Settings of an axis by the name a user knows them by, whichever module keeps them.
 *
 * A module that needs to know a speed asks for "SPEED", as a host would, and need not know who owns
 * it. Main loop only: a few hundred string comparisons.
 */
#ifndef MODULES_LOOKUP_H
#define MODULES_LOOKUP_H

#include "core/command.h"

/** The row that holds a command's value for an axis, or NULL: no such setting is built. */
const struct parameter *lookup_parameter(const char *command, unsigned axis);

/** Its value, as a query prints it; `absent` when it is not built. */
double lookup_value(const char *command, unsigned axis, double absent);

#endif
