/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * How each axis moves: SPEED, ACCEL, the errors it must keep, and the gains of its loop.
 * The one place that turns them into the units of the servo (counts and ticks).
 */
#ifndef MODULES_TUNING_H
#define MODULES_TUNING_H

#include "core/module.h"

/** The fastest an axis is driven. */
#define TUNING_SPEED_MAX_MM_PER_S 6.8

/** HALT brakes from the fastest speed to rest in this time. */
#define TUNING_BRAKE_MS 15.0

extern const struct module tuning_module;

/** SPEED and ACCEL of an axis. */
double tuning_speed_mm_per_s(unsigned axis);
double tuning_ramp_ms(unsigned axis);

double tuning_counts_per_s(unsigned axis, double speed_mm_per_s);

/** Ticks in a time, at least one tick; not rounded. */
double tuning_ticks(double time_ms);

/** Give the loop of an axis its settings anew: after a change of what they are made from. */
void tuning_apply(unsigned axis);

/** Finish and drift error in counts, cut off as INFO shows them. */
int32_t tuning_finish_counts(unsigned axis);
int32_t tuning_drift_counts(unsigned axis);

#endif
