/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/tuning.h"

#include "hal/pwm.h"
#include "modules/axis.h"
#include "modules/coordinates.h"

static double speed_mm_per_s[AXIS_COUNT];
static double ramp_ms[AXIS_COUNT];
static double finish_mm[AXIS_COUNT];
static double drift_mm[AXIS_COUNT];
static double wait_ms[AXIS_COUNT];
static double runaway_mm[AXIS_COUNT];
static double kp[AXIS_COUNT], ki[AXIS_COUNT], kd[AXIS_COUNT], kv[AXIS_COUNT], ka[AXIS_COUNT];

/* Not for users: they follow from the motor and the drive (docs/decisions.md). */
static const struct pid_gains fixed_gains = {
    .friction_steps = 250,
    .approach_per_s = 300,
    .knee_counts_per_s = 150,
    .derivative_filter_us = 400,
    .output_limit_steps = PWM_FULL_STEPS,
};

double tuning_speed_mm_per_s(unsigned axis)
{
    return speed_mm_per_s[axis];
}

double tuning_ramp_ms(unsigned axis)
{
    return ramp_ms[axis];
}

double tuning_counts_per_s(unsigned axis, double speed)
{
    return speed * coordinates_counts_per_mm(axis);
}

double tuning_ticks(double time_ms)
{
    double ticks = time_ms * (1000.0 / AXIS_TICK_US);

    return ticks < 1.0 ? 1.0 : ticks;
}

/* The original cuts a setting in mm to whole counts. */
static int32_t counts(unsigned axis, double mm)
{
    double value = mm * coordinates_counts_per_mm(axis);

    return value > COORDINATES_COUNTS_MAX ? COORDINATES_COUNTS_MAX : (int32_t)value;
}

int32_t tuning_finish_counts(unsigned axis)
{
    return counts(axis, finish_mm[axis]);
}

int32_t tuning_drift_counts(unsigned axis)
{
    return counts(axis, drift_mm[axis]);
}

static uint32_t ticks(double time_ms)
{
    return (uint32_t)tuning_ticks(time_ms);
}

void tuning_apply(unsigned axis)
{
    struct pid_gains gains = fixed_gains;
    struct loop_config config = {
        .finish_counts = tuning_finish_counts(axis),
        .drift_counts = tuning_drift_counts(axis),
        .runaway_counts = counts(axis, runaway_mm[axis]),
        .runaway_ticks = ticks(10.0),
        .behind_counts = counts(axis, 0.02),
        .dead_ticks = ticks(100.0),
        .settle_ticks = ticks(2.0),
        .settle_limit_ticks = ticks(500.0),
        .wait_ticks = wait_ms[axis] > 0 ? ticks(wait_ms[axis]) : 0,
        .lead_ticks = ticks(0.6),
        .nudge = {
            .reach_counts = 24,
            .first_steps = 1000,
            .limit_steps = PWM_FULL_STEPS,
            .pulse_ticks = ticks(0.2),
            .rest_ticks = ticks(0.8),
        },
    };

    /* A drift error below the finish error would have the axis corrected for ever. */
    if (config.drift_counts < config.finish_counts)
        config.drift_counts = config.finish_counts;
    gains.kp = (int32_t)kp[axis];
    gains.ki = (int32_t)ki[axis];
    gains.kd = (int32_t)kd[axis];
    gains.kv = (int32_t)kv[axis];
    gains.ka = (int32_t)ka[axis];
    pid_configure(&config.pid, &gains, AXIS_TICK_US);
    axis_configure(axis, &config);
}

static void changed(unsigned axis, double value)
{
    (void)value;
    tuning_apply(axis);
}

#define PER_AXIS .letter = PARAMETER_AXES, .saved = SAVED_BY_SS
#define GAIN .type = PARAMETER_INTEGER, .minimum = 0, .maximum = 32767, .set = changed

static const struct parameter parameters[] = {
    {
        .command = "SPEED", PER_AXIS, .type = PARAMETER_REAL, .decimals = 6, .unit = "mm/s",
        .summary = "Largest speed of moves, and the speed of scan lines.",
        .minimum = 1e-6, .maximum = TUNING_SPEED_MAX_MM_PER_S, .above = OUTSIDE_CLIP,
        .initial = 0.67 * TUNING_SPEED_MAX_MM_PER_S, .value = speed_mm_per_s,
    },
    {
        .command = "ACCEL", PER_AXIS, .type = PARAMETER_INTEGER, .unit = "ms",
        .summary = "Time from rest to full speed, and back.",
        .minimum = 1, .maximum = 32767, .initial = 50, .value = ramp_ms,
    },
    {
        .command = "PCROS", PER_AXIS, .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .summary = "Finish error: a move is complete when it is this near its target.",
        .minimum = 1e-9, .maximum = 1000, .below = OUTSIDE_IGNORE,
        .initial = 0.000022, .value = finish_mm, .set = changed,
    },
    {
        .command = "ERROR", PER_AXIS, .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .summary = "Drift error: an axis at rest is corrected when it is further off.",
        .minimum = 1e-9, .maximum = 1000, .below = OUTSIDE_IGNORE,
        .initial = 0.0004, .value = drift_mm, .set = changed,
    },
    {
        .command = "WAIT", PER_AXIS, .type = PARAMETER_INTEGER, .unit = "ms",
        .summary = "Pause after a move, servo active and busy.",
        .minimum = 0, .maximum = 32767, .initial = 0, .value = wait_ms, .set = changed,
    },
    {
        .command = "RUNAWAY", PER_AXIS, .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .summary = "Error beyond which an axis that moves away is stopped.",
        .minimum = 0.001, .maximum = 1000, .initial = 2, .value = runaway_mm, .set = changed,
    },
    {
        .command = "KP", PER_AXIS, GAIN, .unit = "1/64 step per count",
        .summary = "Proportional gain.", .initial = 160, .value = kp,
    },
    {
        .command = "KI", PER_AXIS, GAIN, .unit = "1/1024 step per count and ms",
        .summary = "Integral gain.", .initial = 150, .value = ki,
    },
    {
        .command = "KD", PER_AXIS, GAIN, .unit = "1/8 step per count/ms",
        .summary = "Derivative gain.", .initial = 140, .value = kd,
    },
    {
        .command = "KV", PER_AXIS, GAIN, .unit = "1/16 step per count/ms",
        .summary = "Velocity feed-forward.", .initial = 106, .value = kv,
    },
    {
        .command = "KADC", PER_AXIS, GAIN, .unit = "1/2 step per count/ms^2",
        .summary = "Acceleration feed-forward.", .initial = 93, .value = ka,
    },
    {0},
};

static const struct command commands[] = {
    {.name = "SPEED", .shortcut = "S", .summary = "Speed of moves.", .form = FORM_P},
    {.name = "ACCEL", .shortcut = "AC", .summary = "Ramp time.", .form = FORM_S},
    {.name = "PCROS", .shortcut = "PC", .summary = "Finish error.", .form = FORM_P},
    {.name = "ERROR", .shortcut = "E", .summary = "Drift error.", .form = FORM_S},
    {.name = "WAIT", .shortcut = "WT", .summary = "Pause after a move.", .form = FORM_S},
    {.name = "RUNAWAY", .shortcut = "RU", .summary = "Runaway limit.", .form = FORM_P},
    {.name = "KP", .summary = "Proportional gain.", .form = FORM_P},
    {.name = "KI", .summary = "Integral gain.", .form = FORM_P},
    {.name = "KD", .summary = "Derivative gain.", .form = FORM_P},
    {.name = "KV", .summary = "Velocity feed-forward.", .form = FORM_P},
    {.name = "KADC", .shortcut = "KA", .summary = "Acceleration feed-forward.", .form = FORM_P},
    {0},
};

const struct module tuning_module = {
    .name = "tuning",
    .commands = commands,
    .parameters = parameters,
};
