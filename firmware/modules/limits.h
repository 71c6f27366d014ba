/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Soft limits (SETLOW, SETUP): places of the stage that commanded moves do not pass.
 *
 * A limit keeps its place when HERE, ZERO or RESET rename it, so it is kept in counts; commands give
 * it in user mm. SETLOW is the lower end in the host's coordinates, also when UM mirrors the axis.
 * Limit switches are modules/axis.h's: the interrupt acts on them.
 */
#ifndef MODULES_LIMITS_H
#define MODULES_LIMITS_H

#include <stdbool.h>
#include <stdint.h>

#include "core/fault.h"
#include "core/module.h"

extern const struct module limits_module;

/** Keep the limits of all axes in the settings store as they are now (SAVEPOS). False: not kept. */
bool limits_keep(void);

/** The code of a limit at the high or the low end of the counts: the user's upper or lower one. */
enum fault limits_fault(unsigned axis, bool high);

/**
 * The count itself, or the nearest one that may be gone to from a place: within the limits, or as far
 * outside as the place itself is. So no move goes further out, and none the other way than was asked.
 */
int32_t limits_nearest(unsigned axis, int32_t from_counts, int32_t counts);

/** The same; logs 34 or 35 when the count itself may not be gone to. */
int32_t limits_clip(unsigned axis, int32_t from_counts, int32_t counts);

/** Whether a count is within the limits. */
bool limits_allow(unsigned axis, int32_t counts);

/** At or beyond the limit at the high or the low end of the counts. */
bool limits_at_upper(unsigned axis, int32_t counts);
bool limits_at_lower(unsigned axis, int32_t counts);

#endif
