/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * PID with feed-forward of velocity, acceleration and friction; one axis, integer arithmetic.
 *
 * output = KP e + KI sum(e) + KD de/dt + KV v + KA a + friction(v + approach e), clamped.
 *
 * Feed-forward does the work, so that the error it leaves is small and the gains may be gentle. The
 * friction term is the running friction in the direction the axis *should* go: the set-point's
 * velocity, or towards the set-point when that stands still. Within `knee` of standstill it falls
 * off in proportion, so it does not chatter.
 *
 * Gains are given in physical time and converted once per change to the servo period in use.
 */
#ifndef SERVO_PID_H
#define SERVO_PID_H

#include <stdbool.h>
#include <stdbool.h>
#include <stdint.h>

/** Gains as a user sets them; "step" is one step of PWM duty. Values are clamped to 0..32767. */
struct pid_gains {
    int32_t kp;                   /**< 1/64 step per count. */
    int32_t ki;                   /**< 1/1024 step per count and ms. */
    int32_t kd;                   /**< 1/8 step per count/ms. */
    int32_t kv;                   /**< 1/16 step per count/ms of set-point velocity. */
    int32_t ka;                   /**< 1/2 step per count/ms^2 of set-point acceleration. */
    int32_t friction_steps;       /**< Drive that just keeps the axis moving. */
    int32_t approach_per_s;       /**< Wanted speed per error: counts/s per count. */
    int32_t knee_counts_per_s;    /**< Wanted speed from which friction counts in full. */
    int32_t derivative_filter_us; /**< Time constant of the derivative's filter. */
    int32_t output_limit_steps;   /**< Largest output, at most 8191. */
};

/** What one tick needs, scaled to the period. Read-only in the interrupt. All below 2^31. */
struct pid_config {
    int32_t kp_q18;            /**< Steps per count. */
    int32_t ki_q28;            /**< Steps per count and tick. */
    int32_t kd_q14;            /**< Steps per count/tick. */
    int32_t kv_q14;            /**< Steps per count/tick. */
    int32_t ka_q8;             /**< Steps per count/tick^2. */
    int32_t filter_q27;        /**< Share of a new difference the derivative takes up, up to 1. */
    int32_t approach_q16;      /**< Counts/tick per count, up to 1. */
    int32_t knee_q16;          /**< Counts/tick, above 0, up to 1. */
    int32_t friction_slope_q6; /**< Steps per count/tick; friction_steps at the knee. */
    int32_t output_limit_steps;
};

/** All it remembers. */
struct pid_state {
    int32_t integral_q14;   /**< Steps; within +-output_limit. */
    int32_t error_q8;       /**< Of the last tick, counts. */
    int32_t derivative_q16; /**< Filtered, counts/tick. */
};

/** Errors are clamped to this before use: 4096 counts. */
#define PID_ERROR_LIMIT_Q8 (INT32_C(1) << 20)

/** Rates of set-point and error are clamped to these: 256 counts/tick, 4 counts/tick^2. */
#define PID_VELOCITY_LIMIT_Q16 (INT32_C(1) << 24)
#define PID_ACCELERATION_LIMIT_Q20 (INT32_C(1) << 22)

/** Convert gains for a servo period, 1..10000 us. Main loop only: floating point. */
void pid_configure(struct pid_config *cfg, const struct pid_gains *gains, uint32_t period_us);

/** Forget the past: no integral, and an error that has not changed. */
void pid_reset(struct pid_state *st, int32_t error_q8);

/**
 * One servo tick. Runs in the tick interrupt; touches no hardware.
 *
 * The integral stands still while the output is clamped and the error would drive it further, and
 * never exceeds the output limit. No intermediate result overflows whatever the arguments.
 *
 * @param error_q8         Set-point minus position, counts.
 * @param velocity_q16     Set-point velocity, counts per tick.
 * @param acceleration_q20 Set-point acceleration, counts per tick^2.
 * @return                 PWM duty in steps, within +-output_limit_steps.
 */
int32_t pid_tick(const struct pid_config *cfg, struct pid_state *st, int32_t error_q8,
                 int32_t velocity_q16, int32_t acceleration_q20);

/** Clamp a value to +-limit. */
static inline int32_t pid_clamp(int32_t value, int32_t limit)
{
    return value > limit ? limit : value < -limit ? -limit : value;
}

#endif
