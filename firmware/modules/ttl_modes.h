/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The modes of the TTL connectors: what TTL X=n and TTL Y=n mean, one row each.
 *
 * A module that has a mode gives it as a row of the tables in ttl_modes.c; nothing else knows of it.
 * Main loop only.
 */
#ifndef MODULES_TTL_MODES_H
#define MODULES_TTL_MODES_H

#include <stdbool.h>
#include <stdint.h>

#include "core/axis.h"

struct motion_owner;

/** Builds of the original that the input can be taken for (BUILD F), and all of them in one. */
enum ttl_profile {
    TTL_PROFILE_ALL,
    TTL_PROFILE_IN0_INT,
    TTL_PROFILE_ENC_INT,
    TTL_PROFILE_REPORT_INT,
    TTL_PROFILES,
};

/** Number of a mode that any number but 0 selects, where no row before it has that number. */
#define TTL_IN_ANY (-1)

/** The mode of modules/servo_lock.c. */
#define TTL_IN_SERVO_LOCK 11

/** A move that a trigger starts. */
struct ttl_step {
    const struct motion_owner *owner;
    unsigned axes;
    int32_t target_counts[AXIS_COUNT];
};

/** What the input does in a mode. All functions may be NULL. */
struct ttl_in_mode {
    int number;
    unsigned profiles;     /* that have it: 1 << enum ttl_profile, or-ed; 0 ends the table */
    bool taken;            /* for ttl_in_force alone: TTL X cannot select it, nor be set meanwhile */
    bool pixels;           /* the pixels of a scan give pulses */
    void (*begin)(void);   /* the mode was selected */
    void (*trigger)(void); /* a rising edge at IN0, or bare RM */
    /**
     * The move that the next trigger starts; changes nothing. False: it starts none. While the axes
     * stand it is planned ahead, and the servo tick that sees the edge begins it.
     */
    bool (*step)(struct ttl_step *step);
    void (*stepped)(void); /* it was started, or would have been: on to the next */
    void (*end)(void);     /* another mode is selected */
};

/** What OUT0 does in a mode. */
struct ttl_out_mode {
    int number;            /* below 0 ends the table */
    unsigned argument;     /* of `level` */
    void (*begin)(void);   /* the mode was selected: gives OUT0 its state */
    bool (*level)(unsigned argument); /* of OUT0, asked each turn of the main loop; or NULL */
    void (*end)(void);     /* another mode is selected; or NULL */
};

extern const struct ttl_in_mode ttl_in_modes[];
extern const struct ttl_out_mode ttl_out_modes[];

#endif
