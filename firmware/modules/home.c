/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/home.h"

#include <stddef.h>

#include "core/axis.h"
#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "modules/move.h"

/* Beyond the upper limit of any stage: HOME goes to that. */
#define DEFAULT_MM 1000.0
#define PLACE_MAX_MM 100000.0

static const struct motion_owner owner = {.name = "home", .busy = true, .letter = 'B'};

static int32_t home_counts[AXIS_COUNT]; /* a place of the stage: HERE and ZERO do not shift it */

static enum status home(const struct request *request, struct reply *reply)
{
    int32_t targets[AXIS_COUNT];
    unsigned axes = 0;

    (void)reply;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (request_argument(request, axis_letter(axis)) != NULL) {
            targets[axis] = limits_nearest(axis, motion_place_counts(axis), home_counts[axis]);
            axes |= MOTION_AXIS(axis);
        }
    return move_to(&owner, axes, targets) ? STATUS_OK : STATUS_FAILED;
}

static bool keep(unsigned axis)
{
    return coordinates_keep_place("SETHOME", axis, home_counts[axis]);
}

bool home_keep(void)
{
    bool kept = true;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        kept &= keep(axis);
    return kept;
}

static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        home_counts[axis] = coordinates_kept_place("SETHOME", axis, DEFAULT_MM);
}

static double get(unsigned axis)
{
    return coordinates_counts_to_mm(axis, home_counts[axis]);
}

static void set(unsigned axis, double mm)
{
    home_counts[axis] = coordinates_mm_to_counts(axis, mm);
    (void)keep(axis);
}

/* X+ is here, X- the default. */
static enum status sign(unsigned axis, bool plus, bool act)
{
    if (!act)
        return STATUS_OK;
    if (plus) {
        home_counts[axis] = motion_position_counts(axis);
        (void)keep(axis);
    } else {
        set(axis, DEFAULT_MM);
    }
    return STATUS_OK;
}

static const struct parameter parameters[] = {
    {
        .command = "SETHOME", .letter = PARAMETER_AXES, .type = PARAMETER_REAL, .decimals = 3,
        .unit = "mm", .summary = "Where HOME goes; + is here, - the default.",
        .minimum = -PLACE_MAX_MM, .maximum = PLACE_MAX_MM, .initial = DEFAULT_MM,
        .saved = SAVED_AT_ONCE, .get = get, .set = set, .sign = sign,
    },
    {0},
};

static const struct command commands[] = {
    {
        .name = "HOME", .shortcut = "!", .flags = COMMAND_NEEDS_ARGUMENT, .run = home,
        .summary = "Move to the home position, or the limit before it.",
        .accepts = ARGUMENT_BARE,
    },
    {.name = "SETHOME", .shortcut = "HM", .summary = "Home positions.", .form = FORM_P},
    {0},
};

const struct module home_module = {
    .name = "home", .commands = commands, .parameters = parameters, .init = init,
};
