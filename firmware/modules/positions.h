/* SPDX-License-Identifier: BSD-2-Clause */
/** Positions of axes, all latched at one instant, as WHERE prints them: `:A 1.0 2.0 `. */
#ifndef MODULES_POSITIONS_H
#define MODULES_POSITIONS_H

#include "core/reply.h"
#include "hal/snapshot.h"

/** Write an axis' field, between reply_open(FORM_V) and reply_close. */
void positions_field(struct reply *reply, unsigned axis, const struct snapshot *snapshot);

/** Send those of `axes` (a bit for each) unasked (core/report.h), in hardware order. */
void positions_report(unsigned axes);

#endif
