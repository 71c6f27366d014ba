/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/identify.h"

#include <math.h>

/* Positions over which a speed is taken. */
#define WINDOW 32u

/* The axis as a mass on a spring: natural frequency and damping, and the time of the integral. The
 * default gains of modules/tuning.c are what this gives for the motor of tb/board/plant.toml. */
#define FREQUENCY_PER_MS 0.5185
#define DAMPING 1.174
#define INTEGRAL_MS 85.0

/* A motor's gain is the same in both directions; more than this is an obstacle. */
#define DIFFERENCE_MAX 0.1

#define GAIN_MAX 32767.0

/* Counts from one window's length before `end` to there. */
static double way(const int32_t *position_counts, unsigned end)
{
    return (double)position_counts[end] - position_counts[end - WINDOW];
}

bool identify_is_steady(const int32_t *position_counts, unsigned turns)
{
    double now, before;

    if (turns < 2 * WINDOW + 1)
        return false;
    now = way(position_counts, turns - 1);
    before = way(position_counts, turns - 1 - WINDOW);
    return fabs(now - before) <= 0.003 * fabs(now) + 1;
}

bool identify_motor(const struct identify_run *run, struct identify_motor *motor)
{
    const double sign = run->strong_steps > 0 ? 1 : -1;
    const int32_t *at = run->position_counts;
    double strong, weak, time_ms, went;

    if (run->strong_turns <= WINDOW || run->turns <= run->strong_turns + WINDOW)
        return false;
    strong = sign * way(at, run->strong_turns - 1) / (WINDOW * run->turn_ms);
    weak = sign * way(at, run->turns - 1) / (WINDOW * run->turn_ms);
    time_ms = run->first_ms + (run->strong_turns - 1) * run->turn_ms;
    went = sign * ((double)at[run->strong_turns - 1] - at[0]);
    if (!(weak > 0 && strong > weak))
        return false;
    motor->steps_per_speed = sign * (run->strong_steps - run->weak_steps) / (strong - weak);
    motor->friction_steps = sign * run->strong_steps - motor->steps_per_speed * strong;
    motor->time_constant_ms = time_ms - went / strong;
    return motor->time_constant_ms > 0;
}

bool identify_mean(const struct identify_motor *there, const struct identify_motor *back,
                   struct identify_motor *motor)
{
    motor->steps_per_speed = (there->steps_per_speed + back->steps_per_speed) / 2;
    motor->time_constant_ms = (there->time_constant_ms + back->time_constant_ms) / 2;
    motor->friction_steps = (there->friction_steps + back->friction_steps) / 2;
    return motor->friction_steps >= 0 &&
           fabs(there->steps_per_speed - back->steps_per_speed) <=
               DIFFERENCE_MAX * motor->steps_per_speed;
}

/* Rounded; false: out of range. */
static bool set(int32_t *gain, double value)
{
    if (!(value >= 0 && value <= GAIN_MAX))
        return false;
    *gain = (int32_t)lround(value);
    return true;
}

bool identify_gains(const struct identify_motor *motor, struct pid_gains *gains)
{
    /* In steps per count, per count/ms and per count/ms^2. */
    double velocity = motor->steps_per_speed;
    double acceleration = velocity * motor->time_constant_ms;
    double position = acceleration * FREQUENCY_PER_MS * FREQUENCY_PER_MS;
    double damping = fmax(0, 2 * DAMPING * FREQUENCY_PER_MS * acceleration - velocity);

    return set(&gains->kp, 64 * position) && set(&gains->ki, 1024 * position / INTEGRAL_MS) &&
           set(&gains->kd, 8 * damping) && set(&gains->kv, 16 * velocity) &&
           set(&gains->ka, 2 * acceleration) && set(&gains->friction_steps, motor->friction_steps);
}
