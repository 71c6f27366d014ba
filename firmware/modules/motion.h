/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Who moves which axis: owners, motions, stops. Main loop only.
 *
 * Every motion has an owner: a module that has claimed the axis. The owner says what its motion
 * looks like from outside (busy or not, the letters of RDSTAT) and what happens when another
 * module wants the axis. The pipeline behind it is modules/axis.h; targets are counts
 * (modules/coordinates.h converts), and are clipped at the soft limits (modules/limits.h).
 */
#ifndef MODULES_MOTION_H
#define MODULES_MOTION_H

#include <stdbool.h>
#include <stdint.h>

#include "core/module.h"
#include "modules/axis.h"

/** Why an owner's motion ended before its target. */
enum motion_end {
    MOTION_HALTED,   /* HALT */
    MOTION_TAKEN,    /* another owner has the axis now */
    MOTION_LIMIT,    /* ran into a limit switch */
    MOTION_DISABLED, /* MC-, or the drives were inhibited */
    MOTION_FAULT,    /* the loop gave up; the code is in the error log */
};

/** A module that moves axes. Constant; one for each kind of motion. */
struct motion_owner {
    const char *name;
    bool busy;   /* its motion is "commanded": STATUS says B, bit 0 of RDSTAT is set */
    bool holds;  /* busy as long as it has an axis claimed, also between its motions */
    bool open_loop; /* no move for HALT to answer :N-21 for */
    char letter; /* what RS axis+ prints while it moves the axis */

    /**
     * Another owner wants the axis, which this one has claimed. True: let it have the axis (`ended`
     * follows); false: refuse, the other's command fails. NULL: always let go.
     */
    bool (*yield)(unsigned axis, const struct motion_owner *to);

    /**
     * The motion of an axis ended early; it has been stopped, or is braking. The axis stays
     * claimed unless it was MOTION_TAKEN. Called for each claimed axis, moving or not. May be NULL.
     */
    void (*ended)(unsigned axis, enum motion_end why);
};

enum { MOTION_VIAS_MAX = 2 };

/** One axis' part of a motion. */
struct motion_move {
    unsigned axis;
    int32_t target_counts;
    double speed_counts_per_s; /* cruise speed, above 0, at most the axis' maximum */
    double ramp_ms;            /* from rest to speed_counts_per_s, and back; above 0 */
    unsigned via_count;        /* places to go to before, without settling there */
    int32_t via_counts[MOTION_VIAS_MAX];
};

/** A bit for each axis. */
#define MOTION_AXIS(axis) (1u << (axis))
#define MOTION_AXES_ALL ((1u << AXIS_COUNT) - 1u)

/**
 * Take axes, all or none; those another owner has are asked for (its `yield`). An axis taken from
 * a moving owner keeps moving until it is told otherwise.
 *
 * @return  False when an owner refuses; nothing has changed then.
 */
bool motion_claim(unsigned axes, const struct motion_owner *owner);

/** Give axes back. A motion in progress goes on and stays the owner's to the outside. */
void motion_release(unsigned axes, const struct motion_owner *owner);

/** Owner of an axis, or NULL. After motion_release the last one, until another claims it. */
const struct motion_owner *motion_owner(unsigned axis);

/**
 * Start moves, all at the same tick; each replaces what its axis is doing, from its present speed.
 * From the return of this function on the axes are busy, if their owner says so. The axes must be
 * claimed. A disabled axis stays where it is, without an error.
 *
 * With speed and ramp the same as for any other move, a scan line is a move that begins and ends
 * beyond the active part: the speed in between is exactly speed_counts_per_s.
 */
void motion_start(const struct motion_move *moves, unsigned count);

/**
 * Plan moves ahead for a trigger: the tick that finds IN0 risen begins them, all or none, and the
 * axes then are the owner's. They must stand (motion_stands), be free to take, ready, and their ways within the
 * soft limits; any other motion, claim or halt withdraws what is prepared.
 *
 * @return  False: not now, and nothing is prepared.
 */
bool motion_prepare(const struct motion_owner *owner, const struct motion_move *moves,
                    unsigned count);
void motion_unprepare(void);

/** What is prepared may be out of date: it begins only when it has been prepared again, though it be
 * the same. In any context. */
void motion_doubt_prepared(void);

/** What is prepared would begin as it is. False also when it has begun. */
bool motion_is_prepared(void);

/** IN0 rose, or something that counts as that: true when what was prepared has begun, or begins with
 * the next tick. At most once true for each time it was prepared. */
bool motion_trigger(void);

/**
 * Brake axes to rest as fast as the drive allows; the count they stop on is the new target. Ends a
 * pause (WT) as well; axes that brake already go on doing so.
 */
void motion_stop(unsigned axes);

/** Stop everything and tell all owners MOTION_HALTED. True: a commanded motion was in progress. */
bool motion_halt(void);

/** Take an axis out of control (drive off) or back (at rest where it is). */
void motion_enable(unsigned axis, bool enable);

/** Switch an axis off that has a fault; until it is enabled again. */
void motion_fail(unsigned axis);
bool motion_enabled(unsigned axis);

/** The axis would move if it were told to: enabled, and the emergency stop is not pressed. */
bool motion_ready(unsigned axis);

/** A commanded motion is in progress, on any axis or on one; true until the pause (WT) is over. */
bool motion_busy(void);
bool motion_axis_busy(unsigned axis);

/** The same of an axis, but for the time that its owner holds it between motions. */
bool motion_axis_moves(unsigned axis);

/** At rest and arrived: no motion pending, moving, settling or pausing. */
bool motion_in_position(unsigned axis);

/** Its set-point is at rest and stays there, though the axis may still be settling on it. */
bool motion_stands(unsigned axis);

/** Position as of the last servo tick. */
int32_t motion_position_counts(unsigned axis);

/**
 * Where the axis is: at rest its target, which friction holds it near, otherwise its position.
 */
int32_t motion_place_counts(unsigned axis);

/** Where the axis is or will be at rest: target of the last move, or where it was stopped. */
int32_t motion_target_counts(unsigned axis);

/** The fastest an axis may be told to go. */
double motion_speed_max_mm_per_s(unsigned axis);

/** Hooks of the main loop: plans that came late, and what the interrupt has to report. */
extern const struct module motion_module;

#endif
