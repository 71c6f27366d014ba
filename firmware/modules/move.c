/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/move.h"

#include <stddef.h>

#include "core/axis.h"
#include "hal/snapshot.h"
#include "modules/approach.h"
#include "modules/coordinates.h"
#include "modules/motion.h"
#include "modules/positions.h"
#include "modules/tuning.h"
#include "modules/verbose.h"

/* Commanded over serial: busy, and given up to whoever asks. */
static const struct motion_owner serial_owner = {
    .name = "serial",
    .busy = true,
    .letter = 'B',
};

static bool names_axis(const struct request *request, unsigned axis)
{
    return request->count == 0 || request_argument(request, axis_letter(axis)) != NULL;
}

/* What MOVREL moved last; and as it was asked for. */
static int32_t relative_counts[AXIS_COUNT];
static double relative_part_counts[AXIS_COUNT];

int32_t move_relative_counts(unsigned axis)
{
    return relative_counts[axis];
}

double move_relative_part_counts(unsigned axis)
{
    return relative_part_counts[axis];
}

void move_set_relative_counts(unsigned axis, int32_t counts)
{
    relative_counts[axis] = counts;
    relative_part_counts[axis] = counts;
}

void move_set_relative(unsigned axis, double user)
{
    relative_counts[axis] = coordinates_distance_to_counts(axis, user);
    relative_part_counts[axis] = coordinates_distance_to_part_counts(axis, user);
}

static struct motion_move move_of(unsigned axis, int32_t target_counts)
{
    return (struct motion_move){
        .axis = axis,
        .target_counts = target_counts,
        .speed_counts_per_s = tuning_counts_per_s(axis, tuning_speed_mm_per_s(axis)),
        .ramp_ms = tuning_ramp_ms(axis),
    };
}

/* The moves of some axes; how many. */
static unsigned moves_of(unsigned axes, const int32_t *target_counts, struct motion_move *moves)
{
    unsigned count = 0;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0) {
            moves[count] = move_of(axis, target_counts[axis]);
            approach_plan(&moves[count++]);
        }
    return count;
}

bool move_to(const struct motion_owner *owner, unsigned axes, const int32_t *target_counts)
{
    struct motion_move moves[AXIS_COUNT];

    if (!motion_claim(axes, owner))
        return false;
    motion_start(moves, moves_of(axes, target_counts, moves));
    return true;
}

bool move_prepare(const struct motion_owner *owner, unsigned axes, const int32_t *target_counts)
{
    struct motion_move moves[AXIS_COUNT];

    return motion_prepare(owner, moves, moves_of(axes, target_counts, moves));
}

/* The targets of a line; returns the axes that it moves. Relative values are remembered. */
static unsigned read_targets(const struct request *request, bool relative, int32_t *target_counts)
{
    unsigned axes = 0;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        if (argument == NULL || argument->kind == ARGUMENT_QUERY)
            continue;
        axes |= MOTION_AXIS(axis);
        if (!relative) {
            target_counts[axis] = coordinates_user_to_counts(axis, argument->value);
            continue;
        }
        move_set_relative(axis, argument->value);
        /* Both within +-2^30. */
        target_counts[axis] = motion_target_counts(axis) + relative_counts[axis];
    }
    return axes;
}

static void (*relative_taken)(void);

void move_take_relative(void (*changed)(void))
{
    relative_taken = changed;
}

static enum status start(const struct request *request, bool relative)
{
    int32_t target_counts[AXIS_COUNT];
    unsigned axes = read_targets(request, relative, target_counts);

    if (relative && relative_taken != NULL) {
        relative_taken();
        return STATUS_OK;
    }
    return move_to(&serial_owner, axes, target_counts) ? STATUS_OK : STATUS_FAILED;
}

/* Targets of the axes asked with `?`; of all that are named when VB says so. */
static void print_targets(const struct request *request, struct reply *reply)
{
    reply_open(reply, FORM_P);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        if (argument == NULL ||
            (argument->kind != ARGUMENT_QUERY && !verbose_prints_targets()))
            continue;
        reply_field(reply, axis_letter(axis));
        reply_number(reply, coordinates_counts_to_user(axis, motion_target_counts(axis)),
                     (unsigned)reply_position_decimals);
    }
    reply_close(reply);
}

static enum status move(const struct request *request, struct reply *reply)
{
    enum status status = start(request, false);

    print_targets(request, reply);
    return status;
}

static enum status movrel(const struct request *request, struct reply *reply)
{
    enum status status = start(request, true);

    print_targets(request, reply);
    return status;
}

/* One axis a step, all as they were at the first: the reply begins to leave with the first number. */
static enum status where(const struct request *request, struct reply *reply)
{
    static struct snapshot snapshot;
    unsigned axis = reply->step;

    if (axis == 0) {
        snapshot_now(&snapshot);
        reply_open(reply, FORM_V);
    }
    while (!names_axis(request, axis))
        axis++;
    positions_field(reply, axis, &snapshot);
    do
        axis++;
    while (axis < AXIS_COUNT && !names_axis(request, axis));
    reply->step = axis;
    if (axis < AXIS_COUNT)
        return STATUS_PENDING;
    reply_close(reply);
    return STATUS_OK;
}

static void name(unsigned axis, double user)
{
    coordinates_name(axis, motion_place_counts(axis), user);
    events_publish(EVENT_ORIGIN_MOVED, axis, events_now());
}

static enum status here(const struct request *request, struct reply *reply)
{
    (void)reply;
    for (size_t i = 0; i < request->count; i++) {
        const struct argument *argument = &request->arguments[i];

        if (!coordinates_fits((unsigned)axis_index(argument->letter), argument->value))
            return STATUS_RANGE;
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        if (argument != NULL)
            name(axis, argument->value);
    }
    return STATUS_OK;
}

static enum status zero(const struct request *request, struct reply *reply)
{
    (void)reply;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (names_axis(request, axis))
            name(axis, 0.0);
    return STATUS_OK;
}

/* HALT acts as soon as its line is known and is answered in its turn. Again in its turn: a move
 * that stood between was told before it. */
static enum status halt(const struct request *request, struct reply *reply)
{
    bool commanded = motion_halt();

    (void)reply;
    return commanded || request->acted ? STATUS_HALTED : STATUS_OK;
}

static const struct command commands[] = {
    {
        .name = "MOVE", .shortcut = "M", .summary = "Move to a place, in user units.",
        .flags = COMMAND_NEEDS_ARGUMENT, .run = move,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_QUERY,
    },
    {
        .name = "MOVREL", .shortcut = "R", .summary = "Move by a distance, in user units.",
        .flags = COMMAND_NEEDS_ARGUMENT, .run = movrel,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_QUERY,
    },
    {
        .name = "WHERE", .shortcut = "W", .summary = "Positions, in user units.",
        .flags = COMMAND_ASKS,
        .form = FORM_V, .run = where, .accepts = ARGUMENT_BARE | ARGUMENT_QUERY,
    },
    {
        .name = "HERE", .shortcut = "H", .summary = "Name the present place, in user units.",
        .flags = COMMAND_NEEDS_ARGUMENT, .run = here,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE,
    },
    {
        .name = "ZERO", .shortcut = "Z", .summary = "Let the present place be 0.",
        .run = zero, .accepts = ARGUMENT_BARE,
    },
    {
        .name = "HALT", .shortcut = "\\", .summary = "Stop everything.",
        .run = halt, .urgent = motion_halt, .letters = LETTERS_ALL,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_QUERY | ARGUMENT_PLUS | ARGUMENT_MINUS,
    },
    {0},
};

const struct module move_module = {
    .name = "move",
    .commands = commands,
};
