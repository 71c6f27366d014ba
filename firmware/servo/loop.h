/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Closed loop of one axis: follows the set-point, decides when it has arrived, lets go, and watches
 * for drift.
 *
 *     FREE    not regulated: disabled, inhibited or stopped by a limit; duty 0
 *     IDLE    arrived, drive off; SETTLE when the axis drifts, TRACK when the set-point moves
 *     TRACK   the set-point moves
 *     SETTLE  the set-point stands; brings the axis within the finish error, where it must stay
 *             for settle_ticks
 *     WAIT    arrived; as SETTLE, for the pause the user asked for
 *
 * Friction holds an axis that has arrived, so within the finish error the drive is off and nothing
 * hunts. The same friction keeps a servo from moving an axis by a count: once the axis stands still
 * near its target, nudges (servo/nudge.h) take the place of the PID.
 */
#ifndef SERVO_LOOP_H
#define SERVO_LOOP_H

#include "servo/nudge.h"
#include "servo/pid.h"
#include "servo/profile.h"

#include <stdbool.h>
#include <stdint.h>

enum loop_mode { LOOP_FREE, LOOP_IDLE, LOOP_TRACK, LOOP_SETTLE, LOOP_WAIT };

/** Why the loop let go by itself. */
enum loop_fault {
    LOOP_NO_FAULT,
    LOOP_NOT_SETTLED, /**< Nudged, or came no nearer, for settle_limit_ticks. */
    LOOP_DEAD,        /**< Full drive for dead_ticks without any movement. */
    LOOP_RUNAWAY,     /**< Far from the set-point and moving away from it. */
};

/**
 * A drive takes time to become torque (PWM period, winding). So the feed-forward follows the
 * set-point of now, and the axis is expected at the set-point of `lead_ticks` ago.
 */
#define LOOP_LEAD_TICKS 8u

/** Settings, read-only in the interrupt. Errors are magnitudes in counts. */
struct loop_config {
    struct pid_config pid;
    int32_t finish_counts;       /**< Arrived when the error is at most this. */
    int32_t drift_counts;        /**< At rest, corrected when the error is more than this. */
    int32_t runaway_counts;      /**< Beyond this error the axis must not move away. */
    int32_t behind_counts;       /**< At full drive and this far off it has fallen behind. */
    uint32_t runaway_ticks;      /**< Ticks of moving away, net, that make a runaway. */
    uint32_t dead_ticks;         /**< Ticks of full drive without movement: a dead axis. */
    uint32_t settle_ticks;       /**< Ticks in a row within the finish error: arrived. */
    uint32_t settle_limit_ticks; /**< Ticks of nudging, or of coming no nearer, until it gives up. */
    uint32_t wait_ticks;         /**< Pause after a commanded move. */
    uint32_t lead_ticks;         /**< Feed-forward comes this early; below LOOP_LEAD_TICKS. */
    struct nudge_config nudge;
};

/** All it remembers. */
struct loop_state {
    enum loop_mode mode;
    enum loop_fault fault;   /**< Why the mode became FREE; kept until loop_rest. */
    bool commanded;          /**< The motion in progress was asked for; without, WAIT ends. Clear
                                  in IDLE and FREE. */
    int32_t error_counts;    /**< Delayed set-point minus position, last tick, floor. */
    int32_t duty_steps;      /**< Output of the last tick. */
    int32_t position_counts; /**< Of the last tick. */
    uint32_t mode_ticks;     /**< Ticks in WAIT, or of nudging in SETTLE. */
    uint32_t near_ticks;     /**< Ticks in a row in SETTLE within the finish error. */
    int32_t nearest_counts;  /**< Least error in SETTLE so far. */
    uint32_t vain_ticks;     /**< Ticks in SETTLE since the error was less than ever before. */
    uint32_t still_ticks;    /**< Ticks in a row without a change of position; saturates. */
    uint32_t dead_ticks;     /**< Ticks in a row of full drive without one. */
    uint32_t away_ticks;     /**< Ticks of moving away less ticks of coming nearer. */
    bool behind;             /**< At full drive, and still too far off; until half of that. */
    uint32_t late_ticks;     /**< Ticks for which the delayed set-point still moves. */
    uint32_t newest;         /**< Index of the last set-point in the ring. */
    struct pid_state pid;
    struct nudge_state nudge;
    int64_t setpoint_q32[LOOP_LEAD_TICKS]; /**< Ring of the last ones, counts. */
};

/** Stop regulating at once. */
void loop_free(struct loop_state *st, enum loop_fault fault);

/**
 * Regulate again, from rest: the caller has put the set-point where the axis is. Clears the fault.
 */
void loop_rest(struct loop_state *st);

/**
 * One servo tick. Runs in the tick interrupt; touches no hardware.
 *
 * @param profile         The set-point of this tick.
 * @param position_counts Position latched with this tick.
 * @return                PWM duty in steps, within +-output_limit_steps; 0 in FREE and IDLE.
 */
int32_t loop_tick(const struct loop_config *cfg, struct loop_state *st,
                  const struct profile_state *profile, int32_t position_counts);

#endif
