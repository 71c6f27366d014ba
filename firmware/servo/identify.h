/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * What a motor and its stage are, from how they take two steps of drive; and the gains that follow.
 * Floating point: main loop only.
 *
 * The model is that of a DC motor at a voltage, with friction, lead screw and encoder counted in:
 *
 *     time_constant * dv/dt = (drive - friction) / drive_per_speed - v
 *
 * A strong drive from rest until the speed is steady, then a weaker one until it is steady again.
 * The two speeds give drive_per_speed and friction; how far the start lags behind its steady speed
 * gives the time constant: way = speed * (time - time_constant), whatever the winding does.
 */
#ifndef SERVO_IDENTIFY_H
#define SERVO_IDENTIFY_H

#include <stdbool.h>
#include <stdint.h>

#include "servo/pid.h"

/** A run: the longest, and the first part in which the axis must have moved. */
enum { IDENTIFY_TURNS = 800, IDENTIFY_TURNS_DEAD = 100 };

struct identify_run {
    double turn_ms;          /**< From one position to the next, */
    double first_ms;         /**< and from the beginning of the drive to the first. */
    int32_t strong_steps;    /**< Drives; the sign is that of the way. */
    int32_t weak_steps;
    unsigned strong_turns;   /**< Positions before the weak drive. */
    unsigned turns;          /**< All positions. */
    int32_t position_counts[IDENTIFY_TURNS];
};

struct identify_motor {
    double steps_per_speed;  /**< Drive per speed: steps per count/ms. */
    double time_constant_ms;
    double friction_steps;   /**< Drive that just keeps it moving. */
};

/** The speed of the last positions is steady, to 0.3 % and a count. */
bool identify_is_steady(const int32_t *position_counts, unsigned turns);

/** The motor of a run that was steady at the end of both drives. False: no motor goes like that. */
bool identify_motor(const struct identify_run *run, struct identify_motor *motor);

/**
 * The motor behind two runs, there and back: their mean, as a weight on the axis helps one of them.
 * False: they differ by more than a weight can make them.
 */
bool identify_mean(const struct identify_motor *there, const struct identify_motor *back,
                   struct identify_motor *motor);

/**
 * Feed-forward that makes the motor follow by itself, and a PID that places the poles of what is
 * left: the same stiffness for every motor. Other members of `gains` are left alone. False: a gain
 * would be out of its range.
 */
bool identify_gains(const struct identify_motor *motor, struct pid_gains *gains);

#endif
