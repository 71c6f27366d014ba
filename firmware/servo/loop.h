/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Closed loop of one axis: follows the set-point, decides when it has arrived, lets go, and watches
 * for drift.
 *
 *     FREE    not regulated: disabled, inhibited or stopped by a limit; duty 0
 *     SPIN    not regulated: a constant duty (the command SPIN)
 *     IDLE    arrived, drive off; SETTLE when the axis drifts, TRACK when the set-point moves
 *     TRACK   the set-point moves
 *     SETTLE  the set-point stands; brings the axis within the finish error, where it must stay
 *             for settle_turns
 *     WAIT    arrived; as SETTLE, for the pause the user asked for
 *     HOLD    arrived; regulated until the set-point moves again, whatever pushes
 *
 * Friction holds an axis that has arrived, so within the finish error the drive is off and nothing
 * hunts. The same friction keeps a servo from moving an axis by a count: once the axis stands still
 * near its target, nudges (servo/nudge.h) take the place of the PID.
 *
 * Two rates: loop_tick regulates, every servo tick. loop_turn decides and supervises, every
 * LOOP_TURN_TICKS; times in the settings are such turns.
 */
#ifndef SERVO_LOOP_H
#define SERVO_LOOP_H

#include "servo/nudge.h"
#include "servo/pid.h"
#include "servo/profile.h"

#include <stdbool.h>
#include <stdint.h>

/** Servo ticks from one loop_turn to the next: one for each axis, and one for others. */
#define LOOP_TURN_TICKS 5u

enum loop_mode {
    LOOP_FREE,
    LOOP_SPIN,
    LOOP_IDLE,
    LOOP_TRACK,
    LOOP_SETTLE,
    LOOP_WAIT,
    LOOP_HOLD,
};

/** What the loop does once it has arrived. */
enum loop_maintain {
    LOOP_MAINTAIN_CORRECT,   /**< Off; corrects drift; gives up after settle_limit_turns. */
    LOOP_MAINTAIN_FOR_EVER,  /**< The same and never gives up. */
    LOOP_MAINTAIN_HOLD,      /**< HOLD. */
    LOOP_MAINTAIN_RELEASE,   /**< The motion ends at the first sight of the target, WAIT follows. */
    LOOP_MAINTAIN_RESERVED,
    LOOP_MAINTAIN_DISENGAGE, /**< Off, and drift is let be. */
};

/** Why the loop let go by itself. */
enum loop_fault {
    LOOP_NO_FAULT,
    LOOP_NOT_SETTLED, /**< Nudged, or came no nearer, for settle_limit_turns. */
    LOOP_DEAD,        /**< Full drive for dead_turns without any way made. */
    LOOP_RUNAWAY,     /**< Far from the set-point and moving away from it. */
    LOOP_OVERFLOW,    /**< An error beyond LOOP_ERROR_MAX: the counts cannot be right. */
};

/** Errors beyond this are no errors of a stage: 2^28 counts. */
#define LOOP_ERROR_MAX (INT32_C(1) << 28)

/** Way within which an axis at full drive counts as not moving: more than a stuck wire jitters. */
#define LOOP_DEAD_COUNTS 4

/** Settings, read-only in the interrupt. Errors are magnitudes in counts. */
struct loop_config {
    struct pid_config pid;
    /**
     * A drive takes time to become torque (PWM period, winding). So the feed-forward follows the
     * set-point of now, and the axis is expected where a low-pass has the set-point; this is the
     * share of a difference it takes up each tick, below 1.
     */
    int32_t lag_q31;
    int32_t finish_counts;       /**< Arrived when the error is at most this. */
    int32_t drift_counts;        /**< At rest, corrected when the error is more than this. */
    int32_t runaway_counts;      /**< Beyond this error the axis must not move away. */
    int32_t behind_counts;       /**< At full drive and this far off it has fallen behind. */
    uint32_t runaway_turns;      /**< Turns of moving away, net, that make a runaway. */
    uint32_t dead_turns;         /**< Turns of full drive without movement: a dead axis. */
    uint32_t settle_turns;       /**< Turns in a row within the finish error: arrived. */
    uint32_t settle_limit_turns; /**< Turns of nudging, or of coming no nearer, until it gives up. */
    uint32_t wait_turns;         /**< Pause after a commanded move. */
    enum loop_maintain maintain;
    struct nudge_config nudge;
};

/** All it remembers. What every tick touches comes first. */
struct loop_state {
    struct pid_rates rates; /**< Of the settings, where they are at hand. */
    int32_t lag_q31;
    int32_t lag_q16;      /**< The set-point is this far ahead of where the axis is expected. */
    struct pid_state pid;
    int32_t held_steps;   /**< Duty while not `regulated`, */
    uint32_t held_ticks;  /**< for so many ticks; 0: until it is changed. */
    bool regulated;       /**< The PID makes the duty. */
    uint8_t mode;         /**< enum loop_mode */
    uint8_t fault;        /**< enum loop_fault: why the mode became FREE; kept until loop_rest. */
    bool commanded;       /**< The motion in progress was asked for and has not arrived. */

    int32_t error_counts;    /**< Expected place minus position, last turn, floor. */
    int32_t duty_steps;      /**< At the last turn. */
    int32_t position_counts; /**< Of the last turn. */
    uint32_t mode_turns;     /**< Turns in WAIT, or of nudging in SETTLE. */
    uint32_t near_turns;     /**< Turns in a row in SETTLE within the finish error. */
    int32_t nearest_counts;  /**< Least error in SETTLE so far. */
    uint32_t vain_turns;     /**< Turns in SETTLE since the error was less than ever before. */
    uint32_t still_turns;    /**< Turns in a row without a change of position; saturates. */
    uint32_t dead_turns;     /**< Turns in a row of full drive within LOOP_DEAD_COUNTS of: */
    int32_t dead_counts;
    uint32_t away_turns;     /**< Turns of moving away less turns of coming nearer. */
    bool behind;             /**< At full drive, and still too far off; until half of that. */
    struct nudge_state nudge;
};

/** Take settings; before the first turn, and whenever they have changed. */
void loop_configure(struct loop_state *st, const struct loop_config *cfg);

/** Stop regulating at once. */
void loop_free(struct loop_state *st, enum loop_fault fault);

/**
 * Regulate again, from rest: the caller has put the set-point where the axis is. Clears the fault.
 */
void loop_rest(struct loop_state *st);

/** Drive at a constant duty, whatever the set-point; from FREE, SPIN or IDLE. */
void loop_spin(struct loop_state *st, int32_t duty_steps);

/** A plan begins: regulate from this tick on. Not in FREE or SPIN. */
void loop_track(const struct loop_config *cfg, struct loop_state *st, bool commanded);

/**
 * The feed-forward of the set-point as it is, ahead of the next turn: so that the first tick of a
 * plan drives. After loop_track, with the position of the last turn.
 */
void loop_feed(const struct loop_config *cfg, struct loop_state *st,
               const struct profile_state *profile, bool may_fall, bool may_rise);

/**
 * The set-point, at rest, has jumped: regulate from this tick on, and settle there. Not in FREE or
 * SPIN. Of a settling under way the integral is kept, and what watches over the axis.
 */
void loop_jump(const struct loop_config *cfg, struct loop_state *st,
               const struct profile_state *profile, bool may_fall, bool may_rise);

/** Expected place minus position, counts, clamped to what pid_tick takes. */
static inline int32_t loop_error_q16(const struct loop_state *st,
                                     const struct profile_state *profile, int32_t position_counts)
{
    /* In 32 bits: the difference of two positions wraps like the encoder's counter. */
    int32_t whole = (int32_t)((uint32_t)(profile->position_q32 >> 32) - (uint32_t)position_counts -
                              (uint32_t)(st->lag_q16 >> 16));
    int32_t fraction_q16 = (int32_t)((uint32_t)profile->position_q32 >> 16) -
                           (st->lag_q16 & 0xffff);

    if (SELDOM((uint32_t)whole + 4000u > 8000u))
        return whole > 0 ? 4000 * 65536 : -4000 * 65536;
    return whole * 65536 + fraction_q16;
}

/**
 * One servo tick. Runs in the tick interrupt; touches no hardware.
 *
 * @param profile         The set-point of this tick.
 * @param position_counts Position latched with this tick.
 * @return                PWM duty in steps, within +-output_limit_steps.
 */
static inline int32_t loop_tick(struct loop_state *st, const struct profile_state *profile,
                                int32_t position_counts)
{
    uint32_t lag_q16;

    if (SELDOM(!st->regulated)) {
        int32_t held_steps = st->held_steps;

        if (st->held_ticks != 0 && --st->held_ticks == 0)
            st->held_steps = 0;
        return held_steps;
    }
    lag_q16 = (uint32_t)st->lag_q16 + (uint32_t)(profile->step_q48 >> 32);
    lag_q16 -= 2u * (uint32_t)pid_high((int32_t)lag_q16, st->lag_q31);
    st->lag_q16 = (int32_t)lag_q16;
    return pid_tick(&st->rates, &st->pid, loop_error_q16(st, profile, position_counts));
}

/**
 * One turn: after loop_tick of its tick, every LOOP_TURN_TICKS. Runs in the tick interrupt.
 *
 * @param duty_steps          What loop_tick returned.
 * @param may_fall, may_rise  The axis may be driven toward - and +: no limit switch is closed.
 */
void loop_turn(const struct loop_config *cfg, struct loop_state *st,
               const struct profile_state *profile, int32_t position_counts, int32_t duty_steps,
               bool may_fall, bool may_rise);

#endif
