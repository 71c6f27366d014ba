/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Nudges: short pulses of drive that move a standing axis by about a count.
 *
 * Breakaway friction exceeds running friction, so an axis that a slowly growing drive tears loose
 * jumps several counts. A pulse shorter than the motor's time constant gives it a momentum that
 * running friction has spent after a fraction of a count. How strong it must be depends on the
 * friction there, so the pulses grow until the axis moves, and shrink when one went too far.
 */
#ifndef SERVO_NUDGE_H
#define SERVO_NUDGE_H

#include <stdbool.h>
#include <stdint.h>

/** Settings, read-only in the interrupt. */
struct nudge_config {
    int32_t reach_counts; /**< Errors up to this are nudged away. */
    int32_t first_steps;  /**< Strength of the first pulse of a settling. */
    int32_t limit_steps;  /**< Largest strength. */
    uint32_t pulse_ticks; /**< Length of a pulse, at least 1; at most a turn. */
    uint32_t rest_turns;  /**< Standstill to wait for before a pulse, at least 1. */
};

/** All it remembers. */
struct nudge_state {
    bool active;            /**< The axis has come to rest near its target; pulses have begun. */
    int32_t strength_steps; /**< Of the last pulse. */
    int32_t side;           /**< +1 or -1: direction of the last pulse; 0: none yet. */
    int32_t from_counts;    /**< Position at the last pulse. */
    uint32_t wait_turns;    /**< Turns until the next pulse at the earliest. */
};

/** Forget the past: the next pulse is a first one. */
void nudge_reset(const struct nudge_config *cfg, struct nudge_state *st);

/**
 * One turn (servo/loop.h) with an error outside the finish error. Runs in the tick interrupt.
 *
 * @param error_counts  Set-point minus position, not 0.
 * @param still_turns   Turns in a row without a change of position.
 * @return              Strength of a pulse to begin now, within +-limit_steps; 0: none.
 */
int32_t nudge_turn(const struct nudge_config *cfg, struct nudge_state *st, int32_t error_counts,
                   int32_t position_counts, uint32_t still_turns);

#endif
