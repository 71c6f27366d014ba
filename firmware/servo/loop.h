/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Closed loop of one axis: follows the set-point, decides when it has arrived, lets go, and watches for drift.
 *
 *     FREE    not regulated: disabled, inhibited or stopped by a limit; duty 0
 *     IDLE    arrived, drive off; leaves for SETTLE when the axis drifts, for TRACK when the set-point moves
 *     TRACK   the set-point moves
 *     SETTLE  the set-point stands; brings the axis within the finish error and holds it there for settle_ticks
 *     WAIT    arrived, kept under control for the pause the user asked for
 *
 * Friction holds an axis that has arrived, so the drive is off in IDLE and nothing hunts.
 */
#ifndef SERVO_LOOP_H
#define SERVO_LOOP_H

#include "servo/pid.h"
#include "servo/profile.h"

#include <stdbool.h>
#include <stdint.h>

enum loop_mode { LOOP_FREE, LOOP_IDLE, LOOP_TRACK, LOOP_SETTLE, LOOP_WAIT };

/** Why the loop let go by itself. */
enum loop_fault {
    LOOP_NO_FAULT,
    LOOP_NOT_SETTLED, /**< Did not come within the finish error in settle_limit_ticks. */
    LOOP_LOST,        /**< The error exceeded error_limit_counts. */
};

/** Settings, read-only in the interrupt. Errors are magnitudes in counts. */
struct loop_config {
    struct pid_config pid;
    int32_t finish_counts;       /**< Arrived when the error is at most this. */
    int32_t drift_counts;        /**< At rest, corrected when the error is more than this. */
    int32_t error_limit_counts;  /**< Larger errors stop the axis. */
    uint32_t settle_ticks;       /**< Consecutive ticks within the finish error that count as arrived, at least 1. */
    uint32_t settle_limit_ticks; /**< Ticks after which it gives up. */
    uint32_t wait_ticks;         /**< Pause after a commanded move. */
};

/** All it remembers. */
struct loop_state {
    struct pid_state pid;
    enum loop_mode mode;
    enum loop_fault fault;  /**< Why the mode became FREE; kept until loop_rest. */
    bool commanded;         /**< The motion in progress was asked for: busy. Clear in IDLE and FREE. */
    int32_t error_counts;   /**< Set-point minus position at the last tick, whole counts, saturated to 32 bits. */
    int32_t duty_steps;     /**< Output of the last tick. */
    int32_t position_counts; /**< Of the last tick. */
    uint32_t mode_ticks;    /**< Ticks in SETTLE or WAIT. */
    uint32_t near_ticks;    /**< Consecutive ticks in SETTLE within the finish error. */
    uint32_t still_ticks;   /**< Consecutive ticks without a change of position; saturates. */
};

/** Stop regulating at once. */
void loop_free(struct loop_state *st, enum loop_fault fault);

/** Regulate again, from rest: the caller has put the set-point where the axis is. Clears the fault. */
void loop_rest(struct loop_state *st);

/**
 * One servo tick. Runs in the tick interrupt; touches no hardware.
 *
 * @param profile         The set-point of this tick.
 * @param position_counts Position latched with this tick.
 * @return                PWM duty in steps, within +-output_limit_steps; 0 in FREE and IDLE.
 */
int32_t loop_tick(const struct loop_config *cfg, struct loop_state *st, const struct profile_state *profile,
                  int32_t position_counts);

#endif
