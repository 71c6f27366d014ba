/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/coordinates.h"

#include <math.h>
#include <stddef.h>

#include "core/axis.h"
#include "core/settings.h"
#include "modules/tuning.h"

/* Where the user's 0 is, counts; has a fraction, so that HERE names a place exactly. */
static double origin_counts[AXIS_COUNT];

static double units_per_mm[AXIS_COUNT];  /* UM, not 0; negative: mirrored */
static bool reversed[AXIS_COUNT];        /* mirrored once more */
static double counts_per_mm[AXIS_COUNT]; /* CNTS, above 0 */

double coordinates_counts_per_mm(unsigned axis)
{
    return counts_per_mm[axis];
}

/* UM with the sign that holds. */
static double scale(unsigned axis)
{
    return reversed[axis] ? -units_per_mm[axis] : units_per_mm[axis];
}

double coordinates_units_per_mm(unsigned axis)
{
    return scale(axis);
}

bool coordinates_mirrored(unsigned axis)
{
    return scale(axis) < 0;
}

void coordinates_reverse(unsigned axis, bool reverse)
{
    reversed[axis] = reverse;
}

static int32_t whole(double counts)
{
    if (!(counts > -(double)COORDINATES_COUNTS_MAX))
        return -COORDINATES_COUNTS_MAX;
    if (counts > (double)COORDINATES_COUNTS_MAX)
        return COORDINATES_COUNTS_MAX;
    return (int32_t)lround(counts);
}

int32_t coordinates_user_to_counts(unsigned axis, double user)
{
    return whole(origin_counts[axis] + user / scale(axis) * counts_per_mm[axis]);
}

int32_t coordinates_distance_to_counts(unsigned axis, double user)
{
    return whole(coordinates_distance_to_part_counts(axis, user));
}

double coordinates_distance_to_part_counts(unsigned axis, double user)
{
    return user / scale(axis) * counts_per_mm[axis];
}

double coordinates_part_counts_to_distance(unsigned axis, double counts)
{
    return counts / counts_per_mm[axis] * scale(axis);
}

bool coordinates_fits(unsigned axis, double user)
{
    return fabs(user / scale(axis) * counts_per_mm[axis]) <= COORDINATES_COUNTS_MAX;
}

double coordinates_counts_to_user(unsigned axis, int32_t counts)
{
    return ((double)counts - origin_counts[axis]) / counts_per_mm[axis] * scale(axis);
}

static double mm_sign(unsigned axis)
{
    return coordinates_mirrored(axis) ? -1.0 : 1.0;
}

int32_t coordinates_stage_mm_to_counts(unsigned axis, double mm)
{
    return whole(origin_counts[axis] + mm * counts_per_mm[axis]);
}

double coordinates_counts_to_stage_mm(unsigned axis, int32_t counts)
{
    return ((double)counts - origin_counts[axis]) / counts_per_mm[axis];
}

bool coordinates_keep_place(const char *name, unsigned axis, int32_t counts)
{
    return settings_write(settings_key_of(name, AXIS_LETTERS[axis]),
                          coordinates_counts_to_stage_mm(axis, counts));
}

int32_t coordinates_kept_place(const char *name, unsigned axis, double otherwise_mm)
{
    double mm;

    if (!settings_read(settings_key_of(name, AXIS_LETTERS[axis]), &mm))
        mm = otherwise_mm;
    return coordinates_stage_mm_to_counts(axis, mm);
}

int32_t coordinates_mm_to_counts(unsigned axis, double mm)
{
    return coordinates_stage_mm_to_counts(axis, mm_sign(axis) * mm);
}

double coordinates_counts_to_mm(unsigned axis, int32_t counts)
{
    return mm_sign(axis) * coordinates_counts_to_stage_mm(axis, counts);
}

void coordinates_name(unsigned axis, int32_t counts, double user)
{
    origin_counts[axis] = (double)counts - user / scale(axis) * counts_per_mm[axis];
}

void coordinates_set_origin(unsigned axis, int32_t counts)
{
    origin_counts[axis] = counts;
}

static enum status check_units(unsigned axis, double value)
{
    (void)axis;
    return fabs(value) >= 1e-6 ? STATUS_OK : STATUS_RANGE;
}

static void rescaled(unsigned axis, double value)
{
    (void)value;
    tuning_apply(axis);
}

void coordinates_set_scale(unsigned axis, double scale)
{
    counts_per_mm[axis] = scale;
    rescaled(axis, scale);
}

static const struct parameter parameters[] = {
    {
        .command = "UM", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 6,
        .unit = "1/mm", .summary = "User units per mm; negative mirrors the axis.",
        .minimum = -1e9, .maximum = 1e9, .initial = 10000, .saved = SAVED_BY_SS,
        .value = units_per_mm, .check = check_units, .taken = "-1e9 ... -1e-6, 1e-6 ... 1e9",
    },
    {
        .command = "CNTS", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 1,
        .decimals_max = 6, .unit = "counts/mm", .summary = "Encoder counts per mm.",
        .minimum = 1, .maximum = 1e6, .initial = 45396, .saved = SAVED_BY_SS,
        .value = counts_per_mm, .set = rescaled,
    },
    {0},
};

static const struct command commands[] = {
    {.name = "UM", .summary = "User units.", .form = FORM_S},
    {.name = "CNTS", .shortcut = "C", .summary = "Encoder scale.", .form = FORM_S},
    {0},
};

const struct module coordinates_module = {
    .name = "coordinates",
    .commands = commands,
    .parameters = parameters,
};
