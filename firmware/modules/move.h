/* SPDX-License-Identifier: BSD-2-Clause */
/** Moves a host commands, and places: MOVE, MOVREL, WHERE, HERE, ZERO, HALT; and moves like theirs for other modules. */
#ifndef MODULES_MOVE_H
#define MODULES_MOVE_H

#include "core/module.h"

struct motion_owner;

extern const struct module move_module;

/**
 * Move axes (a mask, MOTION_AXIS) to places, each at its own speed and ramp, starting together.
 *
 * @param target_counts  AXIS_COUNT of them; those of other axes are not looked at.
 * @return               False: an axis is another owner's, who keeps it; nothing moves.
 */
bool move_to(const struct motion_owner *owner, unsigned axes, const int32_t *target_counts);

/**
 * Plan the same moves ahead, for motion_trigger.
 *
 * @return  False: not now.
 */
bool move_prepare(const struct motion_owner *owner, unsigned axes, const int32_t *target_counts);

/** What MOVREL moved an axis by last, in counts; 0: nothing since the start. As it moved, and as was asked. */
int32_t move_relative_counts(unsigned axis);
double move_relative_part_counts(unsigned axis);
/** Say what that was: for a step that another command sets (ZS). */
void move_set_relative_counts(unsigned axis, int32_t counts);
void move_set_relative(unsigned axis, double user);

/**
 * Until it is called with NULL, MOVREL moves nothing: it sets the distances, of which move_relative_counts
 * tells, and calls this.
 */
void move_take_relative(void (*changed)(void));

#endif
