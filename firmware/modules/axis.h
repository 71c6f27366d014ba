/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The motion pipeline of each axis, once a servo tick: set-point, loop, drive.
 *
 *     plan -> profile -> (transform: none yet) -> loop -> duty
 *
 * Every tick serves what is fast: set-points, PID, duties of all axes. What need not be fast takes
 * turns: switches, enables, modes, feed-forward and supervision of one axis each tick, so each
 * axis' turn comes every LOOP_TURN_TICKS.
 *
 * Two sides. The tick interrupt (axis_tick) owns the profile, the loop and the report of each axis.
 * The main loop owns the settings, the enable switch and the plan that is not in use; it hands a
 * plan over by setting one flag, which either side may clear. Nothing locks: the interrupt cannot
 * be interrupted, and the main loop reads what it changes as a whole (axis_read).
 *
 * Modules use modules/motion.h; this is its other half.
 */
#ifndef MODULES_AXIS_H
#define MODULES_AXIS_H

#include <stdbool.h>
#include <stdint.h>

#include "core/axis.h"
#include "servo/loop.h"

/** PWM periods in a servo tick, and what follows from it: 10 kHz. */
#define AXIS_TICK_PWM_PERIODS 2u
#define AXIS_TICK_US 100u

/** Time from one turn of an axis to the next, in which settings of the loop are counted. */
#define AXIS_TURN_US (AXIS_TICK_US * LOOP_TURN_TICKS)

/** Turns of standstill after which an axis that was let go is regulated again: 10 ms. */
#define AXIS_REST_TURNS (10000u / AXIS_TURN_US)

/** Why the interrupt stopped an axis. */
enum axis_stop {
    AXIS_STOP_NONE,
    AXIS_STOP_LIMIT_LOWER,
    AXIS_STOP_LIMIT_UPPER,
    AXIS_STOP_INHIBITED,   /* emergency stop, or disabled while it moved */
    AXIS_STOP_NOT_SETTLED, /* the loop gave up */
    AXIS_STOP_DEAD,        /* this and the next: off until it is enabled again */
    AXIS_STOP_RUNAWAY,
    AXIS_STOP_OVERFLOW,
};

/** What the interrupt did since the start. The main loop compares with what it has seen. */
struct axis_report {
    uint32_t arrivals;          /* commanded motions that reached their target, pause included */
    uint64_t arrival_time_fast; /* of the last one */
    uint32_t lags; /* times the motor fell behind its set-point at full drive */
    uint32_t stops;
    enum axis_stop last_stop;
    bool stop_at_start; /* the limit switch was closed already when the motion began */
};

/** An axis at one tick; what the loop decides is as of its last turn. */
struct axis_view {
    uint32_t tick; /* the lower bits of its number */
    uint32_t generation; /* counts what puts the set-point elsewhere than predicted */
    struct profile_point setpoint;
    int64_t end_q32;         /* where the motion in progress will end, or the set-point at rest */
    uint64_t begin_tick;     /* of the plan in progress */
    const struct profile_plan *plan; /* in progress, or NULL */
    bool ramping;            /* the set-point accelerates or brakes */
    bool ramping_up;         /* it accelerates */
    bool planned;            /* a plan is in progress */
    enum loop_mode mode;
    bool commanded;          /* the motion in progress was asked for and has not ended */
    int32_t position_counts;
    int32_t error_counts;
    int32_t duty_steps;
    bool limit_lower, limit_upper; /* switch closed */
    bool off;                /* disabled, inhibited or stopped by a fault: not driven */
    struct axis_report report;
};

/** State of a plan that was handed over. */
enum axis_handover {
    AXIS_HANDOVER_NONE,    /* taken, withdrawn, or never made */
    AXIS_HANDOVER_PENDING, /* waits for its tick */
    AXIS_HANDOVER_LATE,    /* did not begin: the axis was elsewhere when its tick came */
    AXIS_HANDOVER_ARMED,   /* waits for the trigger */
};

/** Put all axes at rest where the encoders are, disabled, and start the tick. */
void axis_init(void);

/** The tick interrupt. */
void axis_tick(void);

/** Ticks since the start. */
uint64_t axis_ticks(void);

/** Time of the last tick, fast clocks since reset. */
uint64_t axis_time_fast(void);

/** Processor clocks the tick interrupt took: the last one, and the longest since the start. */
uint32_t axis_tick_cycles(void);
uint32_t axis_tick_cycles_max(void);

/** A commanded motion of the axis has begun and has not ended. */
bool axis_commanded(unsigned axis);

/** Where an axis was at its last turn. */
int32_t axis_position_counts(unsigned axis);

/** Another number whenever something was added to the axis' report. */
uint32_t axis_news(unsigned axis);

/** The axis, all of it as of one tick. */
void axis_read(unsigned axis, struct axis_view *view);

/** What an axis that moves was told and did at its last turn. */
struct axis_sample {
    int32_t target_counts;   /* of the set-point, rounded down */
    int32_t position_counts;
    int32_t duty_steps;
};

/** For hooks of EVENT_SERVO_TURN: its last turn's sample. False: no planned motion in progress. */
bool axis_sample(unsigned axis, struct axis_sample *sample);

/** Give an axis new loop settings; they are copied, and taken as a whole at a tick. */
void axis_configure(unsigned axis, const struct loop_config *config);

/** Switch an axis' drive and loop on or off; off stops it, on also clears a fault. */
void axis_enable(unsigned axis, bool enable);
bool axis_enabled(unsigned axis);

/** The emergency stop holds all drives off, now. */
bool axis_inhibited(void);

/**
 * The set-point an axis will have at a tick from now on, if nothing stops it, and the generation
 * that holds for.
 */
struct profile_point axis_predict(unsigned axis, uint64_t tick, uint32_t *generation);

/** Drive an axis at a constant duty, open loop, until it is 0, or a switch, stop or move ends it. */
void axis_spin(unsigned axis, int32_t duty_steps);

/** Withdraw a plan that has not begun, and get the one to write the next into. */
struct profile_plan *axis_plan(unsigned axis);

/**
 * Hand over the plan from axis_plan, to begin at `tick`.
 *
 * It begins only if the set-point is then what axis_predict said, by its generation; otherwise the
 * handover is late. At rest that holds at any tick, so a plan from rest can only be delayed.
 *
 * @param commanded  The motion is reported when it arrives, after the pause (WT); a stop is neither
 *                   reported nor followed by a pause, and ends the one in progress.
 */
void axis_hand_over(unsigned axis, uint32_t generation, uint64_t tick, bool commanded);

enum axis_handover axis_handover(unsigned axis);

/*
 * The trigger: plans that begin in the tick that finds IN0 risen, together, or none of them.
 *
 *     axis_plan, axis_arm for each axis;  axis_trigger_watch(true)
 *     ...IN0 rises...                     axis_triggers() is one more; or they are late
 *     axis_trigger_watch(false)           from its return on nothing begins by itself
 */

/** As axis_hand_over, but the plan waits for the trigger. */
void axis_arm(unsigned axis, uint32_t generation, bool commanded);

/** Look at IN0 each tick, or not: at edges that inputs_take_edges has not taken, so it tells of them. */
void axis_trigger_watch(bool watch);

/** While it is held the rising of IN0 begins nothing. In any context; axis_trigger_watch ends it. */
void axis_trigger_hold(void);

/** IN0 rose, and the main loop takes its edge before a tick has seen it. */
void axis_trigger_notice(void);

/** The next tick begins what is armed, as if IN0 had risen. */
void axis_trigger_fire(void);

/** Times that armed plans have begun. */
uint32_t axis_triggers(void);

/**
 * What moves set-points at rest, in the tick interrupt, ahead of each tick's regulation: called each
 * tick until it is another, or NULL.
 */
void axis_set_source(void (*source)(void));

/**
 * For a source: let the set-point be a place, in this tick. Not while a plan is in progress or about
 * to begin, nor of an axis that is not regulated: it stays where it is then.
 */
void axis_aim(unsigned axis, int64_t target_q32);

/** The generation that plans must be made for: another one when the set-point is elsewhere. */
uint32_t axis_generation(unsigned axis);

#endif
