/* SPDX-License-Identifier: BSD-2-Clause */
/** DUMP: what the axes did in the last motions, tick by tick, and the error log. */
#ifndef MODULES_DUMP_H
#define MODULES_DUMP_H

#include "core/module.h"

enum { DUMP_STEPS = 200 }; /* samples kept */

extern const struct module dump_module;

#endif
