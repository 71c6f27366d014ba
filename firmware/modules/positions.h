/* SPDX-License-Identifier: BSD-2-Clause */
/** Positions of axes, all latched at one instant, as WHERE prints them: `:A 1.0 2.0 `. */
#ifndef MODULES_POSITIONS_H
#define MODULES_POSITIONS_H

#include "core/reply.h"

/** Write those of `axes` (a bit for each), in hardware order; without axes, nothing. */
void positions_write(struct reply *reply, unsigned axes);

/** Send them unasked (core/report.h). */
void positions_report(unsigned axes);

#endif
