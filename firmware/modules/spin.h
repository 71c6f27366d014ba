/* SPDX-License-Identifier: BSD-2-Clause */
/** SPIN: drive axes at a constant duty, open loop, until they are told otherwise or meet a limit. */
#ifndef MODULES_SPIN_H
#define MODULES_SPIN_H

#include "core/module.h"

extern const struct module spin_module;

#endif
