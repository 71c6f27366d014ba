/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * How each axis moves: SPEED, ACCEL, the errors it must keep, and the gains of its loop.
 * The one place that turns them into the units of the servo (counts and ticks).
 */
#ifndef MODULES_TUNING_H
#define MODULES_TUNING_H

#include "core/module.h"
#include "servo/pid.h"

/** SPEED by default, of the axis' fastest. */
#define TUNING_SPEED_SHARE 0.67

/** HALT brakes from the fastest speed to rest in this time. */
#define TUNING_BRAKE_MS 15.0

extern const struct module tuning_module;

/** SPEED and ACCEL of an axis. */
double tuning_speed_mm_per_s(unsigned axis);
double tuning_ramp_ms(unsigned axis);

/** The fastest an axis is driven. */
double tuning_speed_max_mm_per_s(unsigned axis);

/** Give SPEED another value. */
void tuning_set_speed(unsigned axis, double speed_mm_per_s);

double tuning_counts_per_s(unsigned axis, double speed_mm_per_s);

/** Ticks in a time, at least one tick; not rounded. */
double tuning_ticks(double time_ms);

/** Ticks the acceleration of moves takes to come and to go (JERK); 0: at once. */
double tuning_jerk_ticks(unsigned axis);

/** Give the loop of an axis its settings anew: after a change of what they are made from. */
void tuning_apply(unsigned axis);

/** The gains of an axis as KP, KI, KD, KV, KADC and KF have them, without AALIGN's strength. */
struct pid_gains tuning_gains(unsigned axis);
void tuning_set_gains(unsigned axis, const struct pid_gains *gains);

/** DACK: speed of the motor for a 128th of full drive, by KV. */
double tuning_mm_per_s_per_dac_count(unsigned axis);

/** Finish and drift error in counts, cut off as INFO shows them. */
int32_t tuning_finish_counts(unsigned axis);
int32_t tuning_drift_counts(unsigned axis);

#endif
