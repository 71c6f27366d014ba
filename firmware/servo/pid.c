/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/pid.h"

#include <math.h>

/* Errors have a say in the direction of friction up to this: 16 counts, far beyond the knee. */
#define APPROACH_LIMIT_Q16 (INT32_C(1) << 20)

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
    cfg->rates.kp_q18 = scaled(gain(gains->kp) / 64.0, 262144.0);
    cfg->rates.ki_q28 = scaled(gain(gains->ki) / 1024.0 * tick_ms, 268435456.0);
    cfg->rates.kd_q14 = scaled(gain(gains->kd) / 8.0 / tick_ms, 16384.0);
    cfg->rates.filter_q31 = scaled(tick_ms / (tick_ms + filter_ms), 2147483648.0);
    cfg->kv_q14 = scaled(gain(gains->kv) / 16.0 / tick_ms, 16384.0);
    cfg->ka_q8 = scaled(gain(gains->ka) / 2.0 / (tick_ms * tick_ms), 256.0);
    cfg->approach_q16 = scaled(fmin(approach, 1.0), 65536.0);
    cfg->knee_q16 = scaled(knee, 65536.0);
    cfg->friction_slope_q6 = scaled(friction_steps / knee, 64.0);
    cfg->output_limit_steps = scaled(limit_steps, 1.0);
    cfg->rates.integral_limit_q14 = cfg->output_limit_steps * 16384;
}

void pid_reset(struct pid_state *st, int32_t error_q16)
{
    st->integral_q14 = 0;
    st->smooth_q16 = pid_clamp(error_q16, PID_ERROR_LIMIT_Q16);
}

/* Widths as in pid_tick:
 *
 *     V  velocity_q16 2^24, up 6 = q22, * kv_q14     A  acceleration_q20 2^22, up 8 = q28, * ka_q8
 *     F  wanted_q16 2^16, up 14 = q30, * slope_q6
 *
 * each below 2^29; and approach * error is below 2^(20-4) * 2^16. */
void pid_feed(const struct pid_config *cfg, struct pid_state *st, int32_t error_q16,
              int32_t velocity_q16, int32_t acceleration_q20, bool may_fall, bool may_rise)
{
    int32_t velocity = pid_clamp(velocity_q16, PID_VELOCITY_LIMIT_Q16 - 1);
    int32_t acceleration = pid_clamp(acceleration_q20, PID_ACCELERATION_LIMIT_Q20 - 1);
    int32_t wanted_q16 =
        velocity + pid_high(pid_clamp(error_q16, APPROACH_LIMIT_Q16) * 256,
                            cfg->approach_q16 * 256);
    int32_t limit_q4 = cfg->output_limit_steps * 16;
    int32_t feed_q4 = pid_high(pid_clamp(wanted_q16, cfg->knee_q16) * 16384,
                               cfg->friction_slope_q6);

    feed_q4 += pid_high(velocity * 64, cfg->kv_q14);
    feed_q4 += pid_high(acceleration * 256, cfg->ka_q8);
    st->feed_q4 = pid_clamp(feed_q4, 2 * limit_q4);
    st->least_q4 = may_fall ? -limit_q4 : 0;
    st->most_q4 = may_rise ? limit_q4 : 0;
}
