/* SPDX-License-Identifier: BSD-2-Clause */
/** Other letters for axes (Z2B), and which axis focuses (UNLOCK F). */
#ifndef MODULES_LETTERS_H
#define MODULES_LETTERS_H

#include "core/module.h"

extern const struct module letters_module;

/** The axis that focuses: the third, or the last there is. */
unsigned letters_focus_axis(void);

#endif
