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
 * The terms of e are computed every tick (pid_tick), those that change slowly every few (pid_feed).
 * Gains are given in physical time and converted once per change to the servo period in use.
 */
#ifndef SERVO_PID_H
#define SERVO_PID_H

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

/** What a tick needs, scaled to the period. All below 2^31. */
struct pid_rates {
    int32_t kp_q18;             /**< Steps per count. */
    int32_t ki_q28;             /**< Steps per count and tick. */
    int32_t kd_q14;             /**< Steps per count/tick. */
    int32_t filter_q31;         /**< Share of a new difference the derivative takes up, below 1. */
    int32_t integral_limit_q14; /**< Steps: the output limit. */
};

/** All of it. Read-only in the interrupt. */
struct pid_config {
    struct pid_rates rates;
    int32_t kv_q14;            /**< Steps per count/tick. */
    int32_t ka_q8;             /**< Steps per count/tick^2. */
    int32_t approach_q16;      /**< Counts/tick per count, up to 1. */
    int32_t knee_q16;          /**< Counts/tick, above 0, up to 1. */
    int32_t friction_slope_q6; /**< Steps per count/tick; friction_steps at the knee. */
    int32_t output_limit_steps;
};

/** All it remembers. */
struct pid_state {
    int32_t integral_q14; /**< Steps; within +-output_limit. */
    int32_t smooth_q16;   /**< The error, low-passed: the derivative is what the error is off it. */
    int32_t feed_q4;      /**< Steps of feed-forward, from pid_feed; clamped to twice the limit. */
    int32_t least_q4, most_q4; /**< The output is clamped to these; from pid_feed. */
};

/** Errors are clamped to this before use: 4096 counts. */
#define PID_ERROR_LIMIT_Q16 (INT32_C(1) << 28)

/** Rates of set-point and error are clamped to these: 256 counts/tick, 4 counts/tick^2. */
#define PID_VELOCITY_LIMIT_Q16 (INT32_C(1) << 24)
#define PID_ACCELERATION_LIMIT_Q20 (INT32_C(1) << 22)

/** Convert gains for a servo period, 1..10000 us. Main loop only: floating point. */
void pid_configure(struct pid_config *cfg, const struct pid_gains *gains, uint32_t period_us);

/** Forget the past: no integral, and an error that has not changed. */
void pid_reset(struct pid_state *st, int32_t error_q16);

/**
 * The feed-forward from now on, and whether the output may be below and above 0. Runs in the tick
 * interrupt, every few ticks.
 *
 * @param error_q16        Set-point minus position, counts.
 * @param velocity_q16     Set-point velocity, counts per tick.
 * @param acceleration_q20 Set-point acceleration, counts per tick^2.
 */
void pid_feed(const struct pid_config *cfg, struct pid_state *st, int32_t error_q16,
              int32_t velocity_q16, int32_t acceleration_q20, bool may_fall, bool may_rise);

/** A condition that seldom holds: what it guards is laid out aside, as a branch taken costs 4 clocks. */
#define SELDOM(condition) __builtin_expect((condition), 0)

/** Clamp a value to +-limit. */
static inline int32_t pid_clamp(int32_t value, int32_t limit)
{
    if (SELDOM(value > limit))
        return limit;
    if (SELDOM(value < -limit))
        return -limit;
    return value;
}

/** The upper half of a product: one instruction. */
static inline int32_t pid_high(int32_t a, int32_t b)
{
#ifdef __riscv
    int32_t high;

    /* The compiler makes four instructions of it where it knows half of the operand's sign. */
    __asm__("mulh %0, %1, %2" : "=r"(high) : "r"(a), "r"(b));
    return high;
#else
    return (int32_t)(((int64_t)a * b) >> 32);
#endif
}

/**
 * One servo tick. Runs in the tick interrupt; touches no hardware.
 *
 * The integral stands still while the output is clamped and the error would drive it further, and
 * never exceeds the output limit. No intermediate result overflows whatever the gains and errors.
 *
 * Widths. Values are moved up to 31 bits, so that the upper half of the product with a gain has 4
 * fraction bits and is below 2^29:
 *
 *     P  error_q16 2^28, up 2 = q18, * kp_q18         I  integral_q14 2^27 >> 10
 *     D  rate_q16 2^24, up 6 = q22, * kd_q14          feed_q4 2^18
 *
 * The rate is 1/2 of (error - smooth) q17, below 2^30, by filter_q31: q16, below 2^29. The
 * integral, at most 2^27, grows by error q18 * ki_q28 = q14, below 2^29.
 *
 * @param error_q16  Set-point minus position, counts, within +-PID_ERROR_LIMIT_Q16.
 * @return           PWM duty in steps, within least_q4 and most_q4.
 */
static inline int32_t pid_tick(const struct pid_rates *cfg, struct pid_state *st,
                               int32_t error_q16)
{
    int32_t integral_q14 = st->integral_q14;
    int32_t rate_q16 = pid_high((error_q16 - st->smooth_q16) * 2, cfg->filter_q31);
    int32_t output_q4 = st->feed_q4;

    st->smooth_q16 += rate_q16;
    output_q4 += pid_high(error_q16 * 4, cfg->kp_q18);
    output_q4 += integral_q14 >> 10;
    output_q4 += pid_high(pid_clamp(rate_q16, PID_VELOCITY_LIMIT_Q16 - 1) * 64, cfg->kd_q14);
    if (SELDOM(output_q4 > st->most_q4)) {
        output_q4 = st->most_q4;
        if (error_q16 > 0)
            return output_q4 >> 4;
    } else if (SELDOM(output_q4 < st->least_q4)) {
        output_q4 = st->least_q4;
        if (error_q16 < 0)
            return output_q4 >> 4;
    }
    st->integral_q14 = pid_clamp(integral_q14 + pid_high(error_q16 * 4, cfg->ki_q28),
                                 cfg->integral_limit_q14);
    return output_q4 >> 4;
}

#endif
