/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/limits.h"

#include <stddef.h>

#include "core/axis.h"
#include "modules/coordinates.h"
#include "modules/motion.h"

/* Default travel from the position at power-up, and the largest that can be set. */
#define TRAVEL_MM 110.0
#define TRAVEL_MAX_MM 100000.0

/* By the order of counts, whatever the user's direction is. */
static int32_t low_counts[AXIS_COUNT];
static int32_t high_counts[AXIS_COUNT];

enum fault limits_fault(unsigned axis, bool high)
{
    return high != coordinates_mirrored(axis) ? FAULT_LIMIT_UPPER : FAULT_LIMIT_LOWER;
}

int32_t limits_nearest(unsigned axis, int32_t from_counts, int32_t counts)
{
    const int32_t high = from_counts > high_counts[axis] ? from_counts : high_counts[axis];
    const int32_t low = from_counts < low_counts[axis] ? from_counts : low_counts[axis];

    if (counts > high)
        return high;
    return counts < low ? low : counts;
}

int32_t limits_clip(unsigned axis, int32_t from_counts, int32_t counts)
{
    const int32_t nearest = limits_nearest(axis, from_counts, counts);

    if (nearest != counts)
        log_error((uint16_t)limits_fault(axis, nearest < counts));
    return nearest;
}

bool limits_allow(unsigned axis, int32_t counts)
{
    return counts >= low_counts[axis] && counts <= high_counts[axis];
}

bool limits_at_upper(unsigned axis, int32_t counts)
{
    return counts >= high_counts[axis];
}

bool limits_at_lower(unsigned axis, int32_t counts)
{
    return counts <= low_counts[axis];
}

/* The limit that is the lower (SETLOW) or the upper one (SETUP) in user coordinates. */
static int32_t *limit(unsigned axis, bool upper)
{
    return upper != coordinates_mirrored(axis) ? &high_counts[axis] : &low_counts[axis];
}

/* The names tell the ends of the counts. */
static bool keep(unsigned axis, bool high)
{
    return high ? coordinates_keep_place("SETUP", axis, high_counts[axis])
                : coordinates_keep_place("SETLOW", axis, low_counts[axis]);
}

bool limits_keep(void)
{
    bool kept = true;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        kept &= keep(axis, false) && keep(axis, true);
    return kept;
}

/* A pair that leaves no room was never kept by SETLOW or SETUP. */
static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        low_counts[axis] = coordinates_kept_place("SETLOW", axis, -TRAVEL_MM);
        high_counts[axis] = coordinates_kept_place("SETUP", axis, TRAVEL_MM);
        if (low_counts[axis] >= high_counts[axis]) {
            low_counts[axis] = coordinates_stage_mm_to_counts(axis, -TRAVEL_MM);
            high_counts[axis] = coordinates_stage_mm_to_counts(axis, TRAVEL_MM);
        }
    }
}

static double get_low(unsigned axis)
{
    return coordinates_counts_to_mm(axis, *limit(axis, false));
}

static double get_up(unsigned axis)
{
    return coordinates_counts_to_mm(axis, *limit(axis, true));
}

/* A limit on the wrong side of the other one is ignored. */
static void set(unsigned axis, bool upper, int32_t counts)
{
    int32_t *side = limit(axis, upper);
    bool high = side == &high_counts[axis];

    if (high ? counts <= low_counts[axis] : counts >= high_counts[axis])
        return;
    *side = counts;
    (void)keep(axis, high);
}

static void set_low(unsigned axis, double mm)
{
    set(axis, false, coordinates_mm_to_counts(axis, mm));
}

static void set_up(unsigned axis, double mm)
{
    set(axis, true, coordinates_mm_to_counts(axis, mm));
}

/* X+ is here, X- the default. */
static enum status sign_low(unsigned axis, bool plus, bool act)
{
    if (act && plus)
        set(axis, false, motion_position_counts(axis));
    else if (act)
        set_low(axis, -TRAVEL_MM);
    return STATUS_OK;
}

static enum status sign_up(unsigned axis, bool plus, bool act)
{
    if (act && plus)
        set(axis, true, motion_position_counts(axis));
    else if (act)
        set_up(axis, TRAVEL_MM);
    return STATUS_OK;
}

static const struct parameter parameters[] = {
    {
        .command = "SETLOW", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 3,
        .unit = "mm", .summary = "Lower soft limit; + is here, - the default.",
        .minimum = -TRAVEL_MAX_MM, .maximum = TRAVEL_MAX_MM, .initial = -TRAVEL_MM,
        .saved = SAVED_AT_ONCE, .get = get_low, .set = set_low, .sign = sign_low,
    },
    {
        .command = "SETUP", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 3,
        .unit = "mm", .summary = "Upper soft limit; + is here, - the default.",
        .minimum = -TRAVEL_MAX_MM, .maximum = TRAVEL_MAX_MM, .initial = TRAVEL_MM,
        .saved = SAVED_AT_ONCE, .get = get_up, .set = set_up, .sign = sign_up,
    },
    {0},
};

static const struct command commands[] = {
    {.name = "SETLOW", .shortcut = "SL", .summary = "Lower soft limits.", .form = FORM_P},
    {.name = "SETUP", .shortcut = "SU", .summary = "Upper soft limits.", .form = FORM_P},
    {0},
};

const struct module limits_module = {
    .name = "limits",
    .commands = commands,
    .parameters = parameters,
    .init = init,
};
