/* SPDX-License-Identifier: BSD-2-Clause */
/** Moves a host commands, and places: MOVE, MOVREL, WHERE, HERE, ZERO, HALT. */
#ifndef MODULES_MOVE_H
#define MODULES_MOVE_H

#include "core/module.h"

extern const struct module move_module;

#endif
