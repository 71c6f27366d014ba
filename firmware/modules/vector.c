/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/vector.h"

#include <math.h>
#include <stddef.h>

#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "modules/tuning.h"

static double velocity_mm_per_s[AXIS_COUNT]; /* in the user's direction */

static void ended(unsigned axis, enum motion_end why)
{
    (void)why;
    velocity_mm_per_s[axis] = 0;
}

static const struct motion_owner owner = {.name = "vector", .letter = 'M', .ended = ended};

static double clipped(unsigned axis, double mm_per_s)
{
    double most = motion_speed_max_mm_per_s(axis);

    return fmax(-most, fmin(most, mm_per_s));
}

/* A move to the limit ahead, with the acceleration that ACCEL and SPEED make. */
static void run(unsigned axis, double mm_per_s)
{
    double speed = fabs(mm_per_s), share = speed / tuning_speed_mm_per_s(axis);
    bool up = (mm_per_s > 0) != coordinates_mirrored(axis);
    struct motion_move move = {
        .axis = axis,
        .target_counts = limits_nearest(axis, motion_place_counts(axis),
                                        up ? COORDINATES_COUNTS_MAX : -COORDINATES_COUNTS_MAX),
        .speed_counts_per_s = tuning_counts_per_s(axis, speed),
        .ramp_ms = tuning_ramp_ms(axis) * fmin(share, 1),
    };

    if (motion_claim(MOTION_AXIS(axis), &owner))
        motion_start(&move, 1);
    else
        velocity_mm_per_s[axis] = 0;
}

static void set(unsigned axis, double mm_per_s)
{
    if (mm_per_s != 0) {
        run(axis, mm_per_s);
    } else if (motion_owner(axis) == &owner) {
        motion_stop(MOTION_AXIS(axis));
        motion_release(MOTION_AXIS(axis), &owner);
    }
}

/* At a limit it has ended, though the axis is still its own. */
static double get(unsigned axis)
{
    return motion_in_position(axis) ? 0 : velocity_mm_per_s[axis];
}

static const struct parameter parameters[] = {
    {
        .command = "VECTOR", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 6,
        .unit = "mm/s", .summary = "Velocity, until a limit, HALT or 0.", .minimum = -1e9,
        .maximum = 1e9, .saved = SAVED_NEVER, .value = velocity_mm_per_s, .adjust = clipped,
        .get = get, .set = set,
    },
    {0},
};

static const struct command commands[] = {
    {.name = "VECTOR", .shortcut = "VE", .summary = "Motion at a velocity.", .form = FORM_P},
    {0},
};

const struct module vector_module = {
    .name = "vector", .commands = commands, .parameters = parameters,
};
