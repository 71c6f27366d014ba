/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/approach.h"

#include <math.h>
#include <stddef.h>

#include "modules/coordinates.h"

static double backlash_mm[AXIS_COUNT], overshoot_mm[AXIS_COUNT];

static int32_t whole_counts(unsigned axis, double mm)
{
    return (int32_t)fmin(floor(mm * coordinates_counts_per_mm(axis) + 1e-6),
                         COORDINATES_COUNTS_MAX);
}

void approach_plan(struct motion_move *move)
{
    unsigned axis = move->axis;
    int32_t target = move->target_counts, way = target - motion_target_counts(axis);
    int32_t up = coordinates_mirrored(axis) ? -1 : 1;
    int32_t backlash = whole_counts(axis, backlash_mm[axis]);
    int32_t overshoot = whole_counts(axis, overshoot_mm[axis]);

    move->via_count = 0;
    if (way == 0)
        return;
    if (backlash > 0 && way * (int64_t)up < backlash)
        move->via_counts[move->via_count++] = target - up * backlash;
    if (overshoot > 0)
        move->via_counts[move->via_count++] = target + (way > 0 ? overshoot : -overshoot);
}

/* The original's answer: what the setting comes to in whole counts, of the scale that holds now. */
static double get_overshoot(unsigned axis)
{
    return whole_counts(axis, overshoot_mm[axis]) / coordinates_counts_per_mm(axis);
}

static const struct parameter parameters[] = {
    {
        .command = "BACKLASH", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 6,
        .unit = "mm", .summary = "Length of the last way of a move, always upward; 0: none.",
        .minimum = 0, .maximum = 100, .saved = SAVED_BY_SS, .value = backlash_mm,
    },
    {
        .command = "OVERSHOOT", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 6,
        .unit = "mm", .summary = "By how much a move passes its target; 0: not.",
        .minimum = 0, .maximum = 100, .saved = SAVED_BY_SS, .value = overshoot_mm,
        .get = get_overshoot,
    },
    {0},
};

static const struct command commands[] = {
    {.name = "BACKLASH", .shortcut = "B", .summary = "Last way of a move.", .form = FORM_S},
    {.name = "OVERSHOOT", .shortcut = "OS", .summary = "Way beyond a target.", .form = FORM_P},
    {0},
};

const struct module approach_module = {
    .name = "approach", .commands = commands, .parameters = parameters,
};
