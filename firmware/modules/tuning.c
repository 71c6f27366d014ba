/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/tuning.h"

#include <math.h>

#include "core/settings.h"
#include "hal/pwm.h"
#include "modules/axis.h"
#include "modules/coordinates.h"
#include "modules/interlock.h"
#include "modules/screw.h"

#define GAIN_MAX 32767

static double speed_mm_per_s[AXIS_COUNT];
static double ramp_ms[AXIS_COUNT];
static double finish_mm[AXIS_COUNT];
static double drift_mm[AXIS_COUNT];
static double wait_ms[AXIS_COUNT];
static double jerk_ms[AXIS_COUNT];
static double maintain[AXIS_COUNT];
static double runaway_mm[AXIS_COUNT];
static double kp[AXIS_COUNT], ki[AXIS_COUNT], kd[AXIS_COUNT], kv[AXIS_COUNT], ka[AXIS_COUNT];
static double friction[AXIS_COUNT];
static double strength[AXIS_COUNT];

/* Not for users: they follow from the motor and the drive (docs/decisions.md). */
static const struct pid_gains fixed_gains = {
    .approach_per_s = 300,
    .knee_counts_per_s = 150,
    .derivative_filter_us = 300,
    .output_limit_steps = PWM_FULL_STEPS,
};

/* From a drive to its torque: the winding's time constant, and half of the tick and the PWM period
 * between them. */
#define LAG_US 600.0

/* AALIGN at which KP, KI and KD count in full; one less is a hundredth less. */
#define STRENGTH_FULL 85

/* Drive is shown in counts of a converter the original had: 128 are full drive. */
#define STEPS_PER_DAC_COUNT (PWM_FULL_STEPS / 128.0)

double tuning_speed_mm_per_s(unsigned axis)
{
    return speed_mm_per_s[axis];
}

double tuning_speed_max_mm_per_s(unsigned axis)
{
    return screw_of(axis)->speed_max_mm_per_s;
}

void tuning_set_speed(unsigned axis, double speed)
{
    speed_mm_per_s[axis] = speed;
}

/* The fastest at most, which hosts find out by asking for more. */
static double clipped(unsigned axis, double speed)
{
    return fmin(speed, tuning_speed_max_mm_per_s(axis));
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

double tuning_jerk_ticks(unsigned axis)
{
    return jerk_ms[axis] * (1000.0 / AXIS_TICK_US);
}

/* Turns of the loop in a time, at least one. */
static uint32_t turns(double time_ms)
{
    double count = ceil(time_ms * (1000.0 / AXIS_TURN_US));

    return count < 1.0 ? 1 : (uint32_t)count;
}

/* A gain with the strength that AALIGN gives it. */
static int32_t strong(unsigned axis, int32_t gain)
{
    return (int32_t)lround(gain * (1 + (strength[axis] - STRENGTH_FULL) / 100));
}

static void apply(unsigned axis)
{
    struct pid_gains gains;
    struct loop_config config = {
        .lag_q31 = (int32_t)(2147483648.0 * AXIS_TICK_US / (AXIS_TICK_US + LAG_US)),
        .finish_counts = tuning_finish_counts(axis),
        .drift_counts = tuning_drift_counts(axis),
        .runaway_counts = counts(axis, runaway_mm[axis]),
        .runaway_turns = turns(10.0),
        .behind_counts = counts(axis, 0.02),
        .dead_turns = turns(100.0),
        .settle_turns = turns(2.0),
        .settle_limit_turns = turns(500.0),
        .wait_turns = wait_ms[axis] > 0 ? turns(wait_ms[axis]) : 0,
        .maintain = (enum loop_maintain)maintain[axis],
        .nudge = {
            .reach_counts = 24,
            .first_steps = 1000,
            .limit_steps = PWM_FULL_STEPS,
            .pulse_ticks = 200u / AXIS_TICK_US,
            .rest_turns = turns(1.0),
        },
    };

    /* A drift error below the finish error would have the axis corrected for ever. */
    if (config.drift_counts < config.finish_counts)
        config.drift_counts = config.finish_counts;
    gains = tuning_gains(axis);
    gains.kp = strong(axis, gains.kp);
    gains.ki = strong(axis, gains.ki);
    gains.kd = strong(axis, gains.kd);
    pid_configure(&config.pid, &gains, AXIS_TICK_US);
    axis_configure(axis, &config);
    interlock_set_motor(axis, &(struct interlock_motor){
                                  .friction_steps = gains.friction_steps,
                                  .inertia_steps_per_counts_per_ms2 = gains.ka / 2.0,
                                  .runaway_counts = config.runaway_counts,
                              });
}

void tuning_apply(unsigned axis)
{
    /* While all of them are set it would be in vain. */
    if (!settings_loading())
        apply(axis);
}

static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        apply(axis);
}

struct pid_gains tuning_gains(unsigned axis)
{
    struct pid_gains gains = fixed_gains;

    gains.kp = (int32_t)kp[axis];
    gains.ki = (int32_t)ki[axis];
    gains.kd = (int32_t)kd[axis];
    gains.kv = (int32_t)kv[axis];
    gains.ka = (int32_t)ka[axis];
    gains.friction_steps = (int32_t)friction[axis];
    return gains;
}

void tuning_set_gains(unsigned axis, const struct pid_gains *gains)
{
    kp[axis] = gains->kp;
    ki[axis] = gains->ki;
    kd[axis] = gains->kd;
    kv[axis] = gains->kv;
    ka[axis] = gains->ka;
    friction[axis] = gains->friction_steps;
    tuning_apply(axis);
}

static void changed(unsigned axis, double value)
{
    (void)value;
    tuning_apply(axis);
}

/* DACK is KV, told as a speed. */
static double velocity_gain(unsigned axis, double mm_per_s_per_count)
{
    return 16 * STEPS_PER_DAC_COUNT * 1000 /
           (mm_per_s_per_count * coordinates_counts_per_mm(axis));
}

static enum status check_dack(unsigned axis, double mm_per_s_per_count)
{
    double gain = round(velocity_gain(axis, mm_per_s_per_count));

    return gain >= 1 && gain <= GAIN_MAX ? STATUS_OK : STATUS_RANGE;
}

static void set_dack(unsigned axis, double mm_per_s_per_count)
{
    kv[axis] = round(velocity_gain(axis, mm_per_s_per_count));
    tuning_apply(axis);
}

double tuning_mm_per_s_per_dac_count(unsigned axis)
{
    return kv[axis] > 0 ? velocity_gain(axis, 1) / kv[axis] : 0;
}

static enum status not_reserved(unsigned axis, double value)
{
    (void)axis;
    return (int)value == LOOP_MAINTAIN_RESERVED ? STATUS_RANGE : STATUS_OK;
}

#define PER_AXIS .letter = PARAMETER_AXES, .saved = SAVED_BY_SS
#define GAIN .type = PARAMETER_INTEGER, .minimum = 0, .maximum = GAIN_MAX, .set = changed

static const struct parameter parameters[] = {
    {
        .command = "SPEED", PER_AXIS, .type = PARAMETER_REAL, .decimals = 6, .unit = "mm/s",
        .summary = "Largest speed of moves, and the speed of scan lines.",
        .minimum = 1e-6, .maximum = 1000, .above = OUTSIDE_CLIP,
        .initial = 6.8 * TUNING_SPEED_SHARE, .value = speed_mm_per_s, .adjust = clipped,
    },
    {
        .command = "ACCEL", PER_AXIS, .type = PARAMETER_INTEGER, .unit = "ms",
        .summary = "Time from rest to full speed, and back.",
        .minimum = 1, .maximum = 32767, .initial = 50, .value = ramp_ms,
    },
    {
        .command = "JERK", PER_AXIS, .type = PARAMETER_INTEGER, .unit = "ms",
        .summary = "Time the acceleration takes to come and to go; 0: at once.",
        .minimum = 0, .maximum = 1000, .initial = 0, .value = jerk_ms,
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
        .command = "MAINTAIN", PER_AXIS, .type = PARAMETER_INTEGER,
        .summary = "At the target: 0 correct drift and give up after 0.5 s, 1 correct for ever, "
                   "2 stay on, 3 done at first sight, 5 let go.",
        .minimum = 0, .maximum = 5, .initial = 0, .value = maintain, .check = not_reserved,
        .set = changed,
    },
    {
        .command = "RUNAWAY", PER_AXIS, .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .summary = "Error beyond which an axis that moves away is stopped.",
        .minimum = 0.001, .maximum = 1000, .initial = 2, .value = runaway_mm, .set = changed,
    },
    {
        .command = "KP", PER_AXIS, GAIN, .unit = "1/64 step per count",
        .summary = "Proportional gain.", .initial = 800, .value = kp,
    },
    {
        .command = "KI", PER_AXIS, GAIN, .unit = "1/1024 step per count and ms",
        .summary = "Integral gain.", .initial = 150, .value = ki,
    },
    {
        .command = "KD", PER_AXIS, GAIN, .unit = "1/8 step per count/ms",
        .summary = "Derivative gain.", .initial = 400, .value = kd,
    },
    {
        .command = "KV", PER_AXIS, GAIN, .unit = "1/16 step per count/ms",
        .summary = "Velocity feed-forward.", .initial = 106, .value = kv,
    },
    {
        .command = "KADC", PER_AXIS, GAIN, .unit = "1/2 step per count/ms^2",
        .summary = "Acceleration feed-forward.", .initial = 93, .value = ka,
    },
    {
        .command = "KF", PER_AXIS, GAIN, .unit = "steps",
        .summary = "Friction feed-forward: drive that just keeps the axis moving.", .initial = 250,
        .value = friction,
    },
    {
        .command = "DACK", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 5,
        .unit = "mm/s", .summary = "Speed of the motor for a 128th of full drive; another way to "
                                   "write KV, and as coarse.",
        .minimum = 1e-9, .maximum = 1000, .initial = 0, .saved = SAVED_NEVER, .check = check_dack,
        .taken = "what KV can be",
        .set = set_dack, .get = tuning_mm_per_s_per_dac_count,
    },
    {
        .command = "AALIGN", .letter = PARAMETER_AXES, .type = PARAMETER_INTEGER, .unit = "%",
        .summary = "Strength of the drive against errors: KP, KI and KD count in full at 85, and a "
                   "hundredth less for each one less.",
        .minimum = 0, .maximum = 99, .initial = STRENGTH_FULL, .saved = SAVED_AT_ONCE,
        .value = strength, .set = changed,
    },
    {0},
};

/* A client sends AA X for a calibration: that must not take the strength away. */
static enum status no_bare_axis(const struct request *request)
{
    for (size_t n = 0; n < request->count; n++)
        if (request->arguments[n].kind == ARGUMENT_BARE)
            return STATUS_MISSING;
    return STATUS_OK;
}

static const struct command commands[] = {
    {.name = "SPEED", .shortcut = "S", .summary = "Speed of moves.", .form = FORM_P},
    {.name = "ACCEL", .shortcut = "AC", .summary = "Ramp time.", .form = FORM_S},
    {.name = "PCROS", .shortcut = "PC", .summary = "Finish error.", .form = FORM_P},
    {.name = "ERROR", .shortcut = "E", .summary = "Drift error.", .form = FORM_S},
    {.name = "JERK", .summary = "Time of change of acceleration.", .form = FORM_P},
    {.name = "MAINTAIN", .shortcut = "MA", .summary = "What an axis does at its target.",
     .form = FORM_P},
    {.name = "WAIT", .shortcut = "WT", .summary = "Pause after a move.", .form = FORM_S},
    {.name = "RUNAWAY", .shortcut = "RU", .summary = "Runaway limit.", .form = FORM_P},
    {.name = "KP", .summary = "Proportional gain.", .form = FORM_P},
    {.name = "KI", .summary = "Integral gain.", .form = FORM_P},
    {.name = "KD", .summary = "Derivative gain.", .form = FORM_P},
    {.name = "KV", .summary = "Velocity feed-forward.", .form = FORM_P},
    {.name = "KADC", .shortcut = "KA", .summary = "Acceleration feed-forward.", .form = FORM_P},
    {.name = "KF", .summary = "Friction feed-forward.", .form = FORM_P},
    {.name = "DACK", .shortcut = "D", .summary = "Speed of the motor.", .form = FORM_S},
    {.name = "AALIGN", .shortcut = "AA", .summary = "Strength of the drive.", .form = FORM_P,
     .check = no_bare_axis},
    {0},
};

const struct module tuning_module = {
    .name = "tuning",
    .commands = commands,
    .parameters = parameters,
    .init = init,
};
