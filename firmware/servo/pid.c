/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/pid.h"

#include <math.h>

/* Errors have a say in the direction of friction up to this: 16 counts, far beyond the knee. */
#define APPROACH_LIMIT_Q8 (INT32_C(1) << 12)

static double gain(int32_t value)
{
    return value < 0 ? 0.0 : value > 32767 ? 32767.0 : (double)value;
}

/* Gains beyond what 31 bits hold saturate. */
static int32_t scaled(double value, double one)
{
    return (int32_t)fmin(value * one + 0.5, 2147483647.0);
}

void pid_configure(struct pid_config *cfg, const struct pid_gains *gains, uint32_t period_us)
{
    double tick_ms = (double)(period_us < 1 ? 1 : period_us > 10000 ? 10000 : period_us) / 1000.0;
    double filter_ms = gain(gains->derivative_filter_us) / 1000.0;
    double approach = gain(gains->approach_per_s) * tick_ms / 1000.0;
    double knee = gain(gains->knee_counts_per_s) * tick_ms / 1000.0;
    double limit_steps = fmin(gain(gains->output_limit_steps), 8191.0);
    double friction_steps = fmin(gain(gains->friction_steps), limit_steps);

    knee = fmin(fmax(knee, 1.0 / 1024.0), 1.0);
    cfg->kp_q18 = scaled(gain(gains->kp) / 64.0, 262144.0);
    cfg->ki_q28 = scaled(gain(gains->ki) / 1024.0 * tick_ms, 268435456.0);
    cfg->kd_q14 = scaled(gain(gains->kd) / 8.0 / tick_ms, 16384.0);
    cfg->kv_q14 = scaled(gain(gains->kv) / 16.0 / tick_ms, 16384.0);
    cfg->ka_q8 = scaled(gain(gains->ka) / 2.0 / (tick_ms * tick_ms), 256.0);
    cfg->filter_q27 = scaled(tick_ms / (tick_ms + filter_ms), 134217728.0);
    cfg->approach_q16 = scaled(fmin(approach, 1.0), 65536.0);
    cfg->knee_q16 = scaled(knee, 65536.0);
    cfg->friction_slope_q6 = scaled(friction_steps / knee, 64.0);
    cfg->output_limit_steps = scaled(limit_steps, 1.0);
}

void pid_reset(struct pid_state *st, int32_t error_q8)
{
    st->integral_q14 = 0;
    st->error_q8 = pid_clamp(error_q8, PID_ERROR_LIMIT_Q8);
    st->derivative_q16 = 0;
}

/* The upper half of a product: one instruction. */
static int32_t high(int32_t a, int32_t b)
{
    return (int32_t)(((int64_t)a * b) >> 32);
}

/* Widths. Values are moved up to 31 bits, so that the upper half of the product with a gain has 4
 * fraction bits and is below 2^29:
 *
 *     P  error_q8 2^20, up 10 = q18, * kp_q18        D  rate_q16 2^24, up 6 = q22, * kd_q14
 *     V  velocity_q16 2^24, up 6 = q22, * kv_q14     A  acceleration_q20 2^22, up 8 = q28, * ka_q8
 *     F  wanted_q16 2^16, up 14 = q30, * slope_q6    I  integral_q14 2^27 >> 10
 *
 * P is below 2^25, as KP is at most 512 steps per count; F and I are at most 2^17. So the sum stays
 * below 2^31. The integral, at most 2^27, grows by error q18 * ki_q28 = q14, below 2^29. */
int32_t pid_tick(const struct pid_config *cfg, struct pid_state *st, int32_t error_q8,
                 int32_t velocity_q16, int32_t acceleration_q20)
{
    int32_t error = pid_clamp(error_q8, PID_ERROR_LIMIT_Q8);
    int32_t velocity = pid_clamp(velocity_q16, PID_VELOCITY_LIMIT_Q16 - 1);
    int32_t acceleration = pid_clamp(acceleration_q20, PID_ACCELERATION_LIMIT_Q20 - 1);
    int32_t rate = pid_clamp((error - st->error_q8) * 256, PID_VELOCITY_LIMIT_Q16 - 1);
    int32_t limit_q4 = cfg->output_limit_steps * 16;
    int32_t wanted_q16, output_q4;

    st->error_q8 = error;
    st->derivative_q16 += high((rate - st->derivative_q16) * 32, cfg->filter_q27);

    wanted_q16 = velocity + pid_clamp(error, APPROACH_LIMIT_Q8) * cfg->approach_q16 / 256;
    output_q4 = high(pid_clamp(wanted_q16, cfg->knee_q16) * 16384, cfg->friction_slope_q6);
    output_q4 += high(error * 1024, cfg->kp_q18);
    output_q4 += high(st->derivative_q16 * 64, cfg->kd_q14);
    output_q4 += high(velocity * 64, cfg->kv_q14);
    output_q4 += high(acceleration * 256, cfg->ka_q8);
    output_q4 += st->integral_q14 / 1024;

    if (output_q4 > limit_q4) {
        output_q4 = limit_q4;
        if (error > 0)
            return output_q4 / 16;
    } else if (output_q4 < -limit_q4) {
        output_q4 = -limit_q4;
        if (error < 0)
            return output_q4 / 16;
    }
    st->integral_q14 = pid_clamp(st->integral_q14 + high(error * 1024, cfg->ki_q28),
                                 cfg->output_limit_steps * 16384);
    return output_q4 / 16;
}
