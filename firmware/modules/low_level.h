/* SPDX-License-Identifier: BSD-2-Clause */
/** The low-level binary format, between 255 66 and 255 65; LLADDR. docs/commands.md lists it. */
#ifndef MODULES_LOW_LEVEL_H
#define MODULES_LOW_LEVEL_H

#include "core/module.h"

extern const struct module low_level_module;

/** Number of an axis in frames: LLADDR. */
uint8_t low_level_address(unsigned axis);

#endif
