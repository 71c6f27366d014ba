/* SPDX-License-Identifier: BSD-2-Clause */
/** The lead screw of each axis (SCREW): what its pitch says of scale and speed. */
#ifndef MODULES_SCREW_H
#define MODULES_SCREW_H

#include "core/module.h"

/** A screw with the encoder that comes with it; the same motor and encoder disc on all. */
struct screw {
    double pitch_mm;
    double counts_per_mm;      /**< CNTS, four counts per line. */
    double speed_max_mm_per_s; /**< The fastest it is driven. */
    double resolution_mm;      /**< What the original settles to; for comparisons. */
};

extern const struct module screw_module;

/** The screw of a pitch, to 1 %, or NULL. */
const struct screw *screw_of_pitch(double pitch_mm);

/** The screw of an axis. */
const struct screw *screw_of(unsigned axis);

#endif
