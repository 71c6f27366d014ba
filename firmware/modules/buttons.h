/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Buttons: what a press does (BCUSTOM, BENABLE). Each press becomes an EVENT_BUTTON and an action,
 * which goes to whoever claims it (modules/modules.c); the claims here are the buttons' own.
 */
#ifndef MODULES_BUTTONS_H
#define MODULES_BUTTONS_H

#include <stdbool.h>

#include "core/module.h"

extern const struct module buttons_module;

/** HOME: as the command HOME of all axes. */
bool buttons_home(void);

/** ZERO: as the command ZERO; with bit 5 of BENABLE Z, of the axis Z alone. */
bool buttons_zero(void);

#endif
