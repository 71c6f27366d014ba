/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/pid.h"

#include <math.h>

/* Just below 16384 counts per tick: with 16 fraction bits, a difference of two fits 32 bits. */
#define DIFFERENCE_LIMIT_Q8 ((INT32_C(1) << 22) - 1)

static double gain(int32_t value)
{
    return value < 0 ? 0.0 : value > 32767 ? 32767.0 : (double)value;
}

static int32_t saturate(double value)
{
    return value >= 2147483647.0 ? INT32_MAX : value <= 0.0 ? 0 : (int32_t)lround(value);
}

void pid_configure(struct pid_config *cfg, const struct pid_gains *gains, uint32_t period_us)
{
    double tick_ms = (double)(period_us < 1 ? 1 : period_us > 10000 ? 10000 : period_us) / 1000.0;
    double knee_per_tick = fmax(1.0, gain(gains->knee_counts_per_s)) * tick_ms / 1000.0;

    cfg->kp_q16 = saturate(gain(gains->kp) / 64.0 * 65536.0);
    cfg->ki_q24 = saturate(gain(gains->ki) / 1024.0 * tick_ms * 16777216.0);
    cfg->kd_q16 = saturate(gain(gains->kd) / 8.0 / tick_ms * 65536.0);
    cfg->kv_q16 = saturate(gain(gains->kv) / 16.0 / tick_ms * 65536.0);
    cfg->ka_q8 = saturate(gain(gains->ka) / 2.0 / (tick_ms * tick_ms) * 256.0);
    cfg->filter_q16 =
        saturate(65536.0 * tick_ms / (tick_ms + gain(gains->derivative_filter_us) / 1000.0));
    cfg->approach_q16 = saturate(gain(gains->approach_per_s) * tick_ms / 1000.0 * 65536.0);
    cfg->friction_steps = saturate(gain(gains->friction_steps));
    /* Below 2^20, so that its product with the wanted speed stays below 2^60. */
    cfg->friction_slope = saturate(fmin(gain(gains->friction_steps) / knee_per_tick, 1048575.0));
    cfg->output_limit_steps = saturate(gain(gains->output_limit_steps));
}

void pid_reset(struct pid_state *st, int32_t error_q8)
{
    st->integral_q32 = 0;
    st->error_q8 = (int32_t)pid_clamp(error_q8, PID_ERROR_LIMIT_Q8);
    st->derivative_q16 = 0;
}

/* Widths. Every product is of a gain below 2^31 and a value of at most 2^30, and enters the sum
 * with 24 fraction bits: P below 2^(31+23), I 2^(15+24), D 2^(31+30-8), V 2^(31+26-8),
 * A 2^(31+26-4), friction 2^(15+24). The sum is below 2^56; the friction product itself below 2^(40+20). */
int32_t pid_tick(const struct pid_config *cfg, struct pid_state *st, int32_t error_q8,
                 int32_t velocity_q16, int32_t acceleration_q20)
{
    int32_t error = (int32_t)pid_clamp(error_q8, PID_ERROR_LIMIT_Q8);
    int32_t velocity = (int32_t)pid_clamp(velocity_q16, PID_VELOCITY_LIMIT_Q16);
    int32_t acceleration = (int32_t)pid_clamp(acceleration_q20, PID_ACCELERATION_LIMIT_Q20);
    int32_t difference_q16 = 256 * (int32_t)pid_clamp(error - st->error_q8, DIFFERENCE_LIMIT_Q8);
    int64_t limit_q24 = (int64_t)cfg->output_limit_steps * (1 << 24);
    int64_t limit_q32 = limit_q24 * 256;
    int64_t integral_q32 = st->integral_q32 + (int64_t)cfg->ki_q24 * error;
    int64_t wanted_q24, output_q24;

    st->error_q8 = error;
    st->derivative_q16 += (int32_t)(
        ((int64_t)(difference_q16 - st->derivative_q16) * cfg->filter_q16) >> 16);

    wanted_q24 = (int64_t)velocity * 256 + (int64_t)cfg->approach_q16 * error;
    output_q24 = (int64_t)cfg->kp_q16 * error;
    output_q24 += ((int64_t)cfg->kd_q16 * st->derivative_q16) >> 8;
    output_q24 += ((int64_t)cfg->kv_q16 * velocity) >> 8;
    output_q24 += ((int64_t)cfg->ka_q8 * acceleration) >> 4;
    output_q24 += pid_clamp(pid_clamp(wanted_q24, INT64_C(1) << 40) * cfg->friction_slope,
                            (int64_t)cfg->friction_steps * (1 << 24));
    output_q24 += st->integral_q32 >> 8;

    /* Anti-windup: integrate only where it does not push a clamped output further. */
    if (output_q24 > limit_q24) {
        output_q24 = limit_q24;
        if (error < 0)
            st->integral_q32 = pid_clamp(integral_q32, limit_q32);
    } else if (output_q24 < -limit_q24) {
        output_q24 = -limit_q24;
        if (error > 0)
            st->integral_q32 = pid_clamp(integral_q32, limit_q32);
    } else {
        st->integral_q32 = pid_clamp(integral_q32, limit_q32);
    }
    return (int32_t)(output_q24 / (1 << 24));
}
