/* SPDX-License-Identifier: BSD-2-Clause */
/** VB: what the controller says of its own accord, and the forms of replies. */
#ifndef MODULES_VERBOSE_H
#define MODULES_VERBOSE_H

#include "core/module.h"

extern const struct module verbose_module;

/** MOVE and MOVREL answer with the new targets (VB X, bit 4). */
bool verbose_prints_targets(void);

#endif
