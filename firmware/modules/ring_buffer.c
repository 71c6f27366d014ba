/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/ring_buffer.h"

#include <stddef.h>

#include "core/action.h"
#include "core/axis.h"
#include "modules/coordinates.h"
#include "modules/motion.h"
#include "modules/move.h"
#include "modules/ttl_modes.h"

/* RBMODE F. */
enum mode {
    MODE_TRIGGERED = 1, /* 0 means the same */
    MODE_PLAY_ONCE = 2,
    MODE_PLAY_ROUND = 3,
    MODE_CONSUME = 4, /* triggered; points gone to are dropped */
    PLAYING = 128,    /* added when asked while it plays */
};

struct point {
    double user[AXIS_COUNT]; /* user units when it is gone to */
    unsigned axes;           /* those that were named; others stay */
};

static void ended(unsigned axis, enum motion_end why);

/* A point by itself; and all points one after the other, which is busy to its end. */
static const struct motion_owner owner = {.name = "ring buffer", .busy = true, .letter = 'B'};
static const struct motion_owner player = {
    .name = "ring buffer play", .busy = true, .holds = true, .letter = 'B', .ended = ended,
};

static struct point points[RING_BUFFER_POINTS];
static unsigned count, pointer;
static double axes_mask, mode, interval_ms;
static bool playing, playing_relative, under_way;
static uint64_t due_fast;

unsigned ring_buffer_axes(void)
{
    return (unsigned)axes_mask & MOTION_AXES_ALL;
}

static void stop_playing(void)
{
    playing = false;
    motion_release(MOTION_AXES_ALL, &player);
}

/* HALT, a limit, a fault, or somebody else has an axis now. */
static void ended(unsigned axis, enum motion_end why)
{
    (void)axis;
    (void)why;
    stop_playing();
}

static void clear(void)
{
    count = 0;
    pointer = 0;
    stop_playing();
}

static bool plays(void)
{
    return mode == MODE_PLAY_ONCE || mode == MODE_PLAY_ROUND;
}

/* --- Steps ------------------------------------------------------------------------------------- */

/* The way to the point that the pointer names. */
static void next_point(bool relative, struct ttl_step *step)
{
    const struct point *point = &points[pointer];

    step->owner = plays() ? &player : &owner;
    step->axes = point->axes & ring_buffer_axes();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        step->target_counts[axis] = coordinates_user_to_counts(axis, point->user[axis]);
        if (relative)
            step->target_counts[axis] = motion_target_counts(axis) +
                                        coordinates_distance_to_counts(axis, point->user[axis]);
    }
}

/* It is under way there: the pointer moves on. */
static void stepped(bool relative)
{
    pointer++;
    if (mode == MODE_CONSUME) {
        count--;
        pointer = 0;
        for (unsigned n = 0; n < count; n++)
            points[n] = points[n + 1];
    }
    if (pointer >= count)
        pointer = 0;
    playing_relative = relative;
    under_way = true;
    due_fast = events_now() + (uint64_t)(interval_ms * EVENTS_FAST_PER_MS);
    events_publish(EVENT_POINT, 1, events_now());
    if (mode == MODE_PLAY_ROUND || (mode == MODE_PLAY_ONCE && pointer != 0))
        playing = true;
    else
        stop_playing();
}

bool ring_buffer_step(struct ttl_step *step)
{
    if (playing || count == 0)
        return false;
    next_point(false, step);
    return true;
}

bool ring_buffer_step_relative(struct ttl_step *step)
{
    if (playing || count == 0)
        return false;
    next_point(true, step);
    return true;
}

void ring_buffer_stepped(void)
{
    stepped(false);
}

void ring_buffer_stepped_relative(void)
{
    stepped(true);
}

void ring_buffer_trigger(void)
{
    stop_playing();
}

/* Go on, if the axes are to be had. */
static bool go_on(bool relative)
{
    struct ttl_step step;

    next_point(relative, &step);
    if (!move_to(step.owner, step.axes, step.target_counts))
        return false;
    stepped(relative);
    return true;
}

static bool arrived(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((ring_buffer_axes() & MOTION_AXIS(axis)) != 0 && motion_axis_moves(axis))
            return false;
    return true;
}

/* The interval counts from start to start; a point that takes longer is waited for. */
static void poll(void)
{
    if (under_way && arrived()) {
        under_way = false;
        events_publish(EVENT_POINT, 0, events_now());
    }
    if (playing && !under_way && events_now() >= due_fast && !go_on(playing_relative))
        stop_playing();
}

/* --- LOAD -------------------------------------------------------------------------------------- */

static double next_of(unsigned axis)
{
    if (count > 0 && (points[pointer].axes & MOTION_AXIS(axis)) != 0)
        return points[pointer].user[axis];
    return coordinates_counts_to_user(axis, motion_target_counts(axis));
}

static double here_of(unsigned axis)
{
    return coordinates_counts_to_user(axis, motion_position_counts(axis));
}

static enum status append(const struct point *point)
{
    if (count == RING_BUFFER_POINTS)
        return STATUS_FAILED;
    points[count++] = *point;
    return STATUS_OK;
}

static enum status load(const struct request *request, struct reply *reply)
{
    struct point point = {.axes = 0};
    enum status status;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        if (argument == NULL || argument->kind == ARGUMENT_QUERY)
            continue;
        if (!coordinates_fits(axis, argument->value))
            return STATUS_RANGE;
        point.axes |= MOTION_AXIS(axis);
        point.user[axis] = argument->kind == ARGUMENT_PLUS ? here_of(axis) : argument->value;
    }
    status = point.axes != 0 ? append(&point) : STATUS_OK;
    reply_open(reply, FORM_P);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        if (argument == NULL || argument->kind != ARGUMENT_QUERY)
            continue;
        reply_field(reply, axis_letter(axis));
        reply_number(reply, next_of(axis), (unsigned)reply_position_decimals);
    }
    reply_close(reply);
    return status;
}

/* --- RBMODE ------------------------------------------------------------------------------------ */

static enum status rbmode(const struct request *request, struct reply *reply)
{
    (void)request;
    (void)reply;
    (void)action_perform(ACTION_RING_NEXT);
    return STATUS_OK;
}

static double get_count(unsigned axis)
{
    (void)axis;
    return mode == MODE_CONSUME ? RING_BUFFER_POINTS - count : count;
}

static void set_count(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    clear();
}

static double get_pointer(unsigned axis)
{
    (void)axis;
    return pointer;
}

static enum status check_pointer(unsigned axis, double value)
{
    (void)axis;
    return value == 0 || value < count ? STATUS_OK : STATUS_RANGE;
}

static void set_pointer(unsigned axis, double value)
{
    (void)axis;
    pointer = (unsigned)value;
}

static double get_mode(unsigned axis)
{
    (void)axis;
    return mode + (playing ? PLAYING : 0);
}

static void set_mode(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    stop_playing();
}

/* --- Buttons ----------------------------------------------------------------------------------- */

bool ring_buffer_button_next(void)
{
    if (playing) {
        stop_playing();
        return true;
    }
    return count > 0 && go_on(false);
}

bool ring_buffer_button_store(void)
{
    struct point point = {.axes = MOTION_AXES_ALL};

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        point.user[axis] = here_of(axis);
    return append(&point) == STATUS_OK;
}

bool ring_buffer_button_clear(void)
{
    clear();
    return true;
}

static const struct command commands[] = {
    {
        .name = "LOAD", .shortcut = "LD", .flags = COMMAND_NEEDS_ARGUMENT, .run = load,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_PLUS | ARGUMENT_QUERY,
        .summary = "Store a point in the ring buffer, in user units; + stores the present place. "
                   "Queries tell the next point.",
    },
    {
        .name = "RBMODE", .shortcut = "RM", .form = FORM_P, .run = rbmode,
        .summary = "The ring buffer; without arguments, what a pulse at IN0 would do.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "RBMODE", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "points",
        .minimum = 0, .maximum = 0, .get = get_count, .set = set_count, .saved = SAVED_NEVER,
        .summary = "0 clears the ring buffer. Query: points stored; with F=4, points free.",
    },
    {
        .command = "RBMODE", .letter = 'Y', .type = PARAMETER_INTEGER, .unit = "bits",
        .minimum = 0, .maximum = 31, .initial = 3, .value = &axes_mask, .saved = SAVED_BY_SS,
        .summary = "Axes that move, the first in bit 0.",
    },
    {
        .command = "RBMODE", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = RING_BUFFER_POINTS - 1, .check = check_pointer,
        .taken = "0 or a point that is loaded",
        .get = get_pointer, .set = set_pointer, .saved = SAVED_NEVER,
        .summary = "Number of the next point, from 0.",
    },
    {
        .command = "RBMODE", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = MODE_CONSUME, .initial = MODE_TRIGGERED, .value = &mode,
        .get = get_mode, .set = set_mode, .saved = SAVED_BY_SS,
        .summary = "A trigger: 1 (and 0) goes to the next point; 2 goes on by itself to the last; "
                   "3 goes round; 4 drops the point it goes to. 128 more when asked while it goes "
                   "by itself.",
    },
    {
        .command = "RTIME", .letter = 'Z', .type = PARAMETER_REAL, .decimals_max = 6, .unit = "ms",
        .minimum = 0, .maximum = 32767, .initial = 0, .value = &interval_ms,
        .saved = SAVED_BY_SS, .summary = "Time between points of the ring buffer when it plays.",
    },
    {0},
};

#define TEXT(number) TEXT_OF(number)
#define TEXT_OF(number) #number

static const char *const build_lines[] = {"RING BUFFER " TEXT(RING_BUFFER_POINTS), NULL};

const struct module ring_buffer_module = {
    .name = "ring buffer", .commands = commands, .parameters = parameters,
    .build_lines = build_lines, .init = clear, .poll = poll,
};
