/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Where the user's 0 of each axis was at a time not long ago, for positions that were latched before
 * HERE or ZERO and are sent after it.
 *
 * Written by the main loop, read by interrupts. Remembers the last ORIGIN_CHANGES changes of an axis;
 * for times before these, the oldest.
 */
#ifndef MODULES_ORIGIN_HISTORY_H
#define MODULES_ORIGIN_HISTORY_H

#include <stdint.h>

enum { ORIGIN_CHANGES = 63 };

/** From now on and for all times before: the origins that hold. While no interrupt reads. */
void origin_history_start(void);

/** The origin of an axis has changed. */
void origin_history_note(unsigned axis);

/** The count of each axis that was the user's 0. Valid until ORIGIN_CHANGES more changes. */
const int32_t *origin_history_at(uint64_t time_fast);

#endif
