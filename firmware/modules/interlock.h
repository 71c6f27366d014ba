/* SPDX-License-Identifier: BSD-2-Clause */
/** Limits for the interlock, and what follows from its faults. */
#ifndef MODULES_INTERLOCK_H
#define MODULES_INTERLOCK_H

#include <stdbool.h>

#include "core/module.h"

/** What the limits of an axis follow from, besides its screw. */
struct interlock_motor {
    double friction_steps;                   /* KF */
    double inertia_steps_per_counts_per_ms2; /* KADC */
    double runaway_counts;                   /* RUNAWAY */
};
void interlock_set_motor(unsigned axis, const struct interlock_motor *motor);

/** That motor is not to be believed, it is being measured: be patient with it. Or no longer. */
void interlock_measure(unsigned axis, bool measured);

/** An axis has a fault whose cause is not gone. */
bool interlock_is_blocked(unsigned axis);

/** Clear the faults of an axis as far as their causes are gone. */
void interlock_release(unsigned axis);

extern const struct module interlock_module;

#endif
