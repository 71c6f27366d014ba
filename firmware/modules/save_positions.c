/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/save_positions.h"

#include <math.h>
#include <stddef.h>

#include "core/axis.h"
#include "core/settings.h"
#include "modules/coordinates.h"
#include "modules/home.h"
#include "modules/limits.h"
#include "modules/motion.h"

static double inhibit;
static bool stored; /* all has been written that is to be kept */
static bool down;

/* Of what is stored: counts from the user's 0. */
static uint32_t key_of(unsigned axis)
{
    return settings_key_of("POSITION", AXIS_LETTERS[axis]);
}

bool save_positions_is_down(void)
{
    return down;
}

/* Forgotten for good before anything can move, or not believed. */
void save_positions_restore(void)
{
    double counts[AXIS_COUNT];

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (!settings_read(key_of(axis), &counts[axis]))
            counts[axis] = NAN;
        (void)settings_write(key_of(axis), NAN);
    }
    settings_poll();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (settings_kept() && !isnan(counts[axis]))
            coordinates_set_origin(axis, motion_position_counts(axis) - (int32_t)counts[axis]);
}

static double counts_from_origin(unsigned axis)
{
    const double mm = coordinates_counts_to_stage_mm(axis, motion_position_counts(axis));

    return round(mm * coordinates_counts_per_mm(axis));
}

/* An axis that is not driven is never in position, and rests where it is. */
static bool all_rest(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (motion_ready(axis) && !motion_in_position(axis))
            return false;
    return true;
}

bool save_positions_keep_places(void)
{
    const bool limits_kept = limits_keep();

    return home_keep() && limits_kept;
}

static bool store(void)
{
    bool stored = save_positions_keep_places();

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        stored &= settings_write(key_of(axis), counts_from_origin(axis));
    return stored;
}

enum step { STEP_BEGIN, STEP_STOP, STEP_STORE };

/* The colon leaves at once, the A when the positions are stored. */
static enum status savepos(const struct request *request, struct reply *reply)
{
    (void)request;
    if (reply->step == STEP_BEGIN) {
        (void)motion_halt();
        reply_char(reply, ':');
        reply->step = STEP_STOP;
        return STATUS_PENDING;
    }
    if (reply->step == STEP_STOP) {
        if (!all_rest())
            return STATUS_PENDING;
        for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
            motion_enable(axis, false);
        stored = store();
        reply->step = STEP_STORE;
    }
    if (settings_pending())
        return STATUS_PENDING;
    down = stored && settings_kept();
    reply_text(reply, down ? "A " : "N-5");
    return STATUS_OK;
}

static void init(void)
{
    down = false;
}

static const struct command commands[] = {
    {
        .name = "SAVEPOS", .shortcut = "SP", .form = FORM_P, .run = savepos,
        .summary = "Stop, store the positions, and be deaf until the power is cycled.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "SAVEPOS", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &inhibit, .saved = SAVED_BY_SS,
        .summary = "1: nothing is stored when the power fails; for boards that notice.",
    },
    {0},
};

const struct module save_positions_module = {
    .name = "save positions", .commands = commands, .parameters = parameters, .init = init,
};
