/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * How a move comes to its target: BACKLASH and OVERSHOOT.
 *
 * BACKLASH: the last way, of that length at least, is always upward in the user's direction.
 * OVERSHOOT: the target is passed by that much, and the axis comes back toward where it was.
 */
#ifndef MODULES_APPROACH_H
#define MODULES_APPROACH_H

#include "core/module.h"
#include "modules/motion.h"

extern const struct module approach_module;

/** Put the places on the way to its target into a move. */
void approach_plan(struct motion_move *move);

#endif
