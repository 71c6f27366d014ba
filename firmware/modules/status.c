/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/status.h"

#include <stddef.h>

#include "core/axis.h"
#include "modules/coordinates.h"
#include "modules/interlock.h"
#include "modules/joystick.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "modules/servo_lock_run.h"

/* Bits of the status byte. */
enum {
    BIT_BUSY = 0x01,
    BIT_ENABLED = 0x02,
    BIT_MOTOR_ON = 0x04,
    BIT_JOYSTICK = 0x08,
    BIT_RAMPING = 0x10,
    BIT_RAMPING_UP = 0x20,
    BIT_UPPER_LIMIT = 0x40,
    BIT_LOWER_LIMIT = 0x80,
};

static bool motor_on(const struct axis_view *view)
{
    return view->mode != LOOP_FREE && view->mode != LOOP_IDLE;
}

/* At the end of the travel that is the upper or the lower one to the user: switch, or soft limit. */
static bool switch_closed(unsigned axis, const struct axis_view *view, bool upper)
{
    return upper != coordinates_mirrored(axis) ? view->limit_upper : view->limit_lower;
}

static bool at_limit(unsigned axis, const struct axis_view *view, bool upper)
{
    return switch_closed(axis, view, upper) ||
           (upper != coordinates_mirrored(axis) ? limits_at_upper(axis, view->position_counts)
                                                : limits_at_lower(axis, view->position_counts));
}

uint8_t status_byte(unsigned axis)
{
    struct axis_view view;
    unsigned bits = joystick_connected(axis) ? BIT_JOYSTICK : 0;

    axis_read(axis, &view);
    bits |= motion_axis_busy(axis) ? BIT_BUSY : 0;
    bits |= motion_enabled(axis) ? BIT_ENABLED : 0;
    bits |= motor_on(&view) ? BIT_MOTOR_ON : 0;
    bits |= view.ramping ? BIT_RAMPING : 0;
    bits |= view.ramping && view.ramping_up ? BIT_RAMPING_UP : 0;
    bits |= switch_closed(axis, &view, true) ? BIT_UPPER_LIMIT : 0;
    bits |= switch_closed(axis, &view, false) ? BIT_LOWER_LIMIT : 0;
    return (uint8_t)bits;
}

char status_limit_letter(unsigned axis)
{
    struct axis_view view;

    axis_read(axis, &view);
    if (!motion_enabled(axis))
        return 'D';
    if (at_limit(axis, &view, true))
        return 'U';
    if (at_limit(axis, &view, false))
        return 'L';
    return ' ';
}

/* And to the right: what moves it, pausing, a correction, or blank. */
static char right_letter(unsigned axis)
{
    const struct motion_owner *owner = motion_owner(axis);
    struct axis_view view;

    axis_read(axis, &view);
    if (servo_lock_has(axis))
        return owner->letter;
    if (view.mode == LOOP_WAIT)
        return 'P';
    if (owner != NULL && (motion_axis_busy(axis) || view.commanded))
        return owner->letter;
    return motor_on(&view) ? 'M' : ' ';
}

static enum status status(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_char(reply, motion_busy() ? 'B' : 'N');
    return STATUS_OK;
}

static void print_state(struct reply *reply, unsigned axis, enum argument_kind kind)
{
    switch (kind) {
    case ARGUMENT_QUERY:
        reply_char(reply, motion_axis_busy(axis) ? 'B' : 'N');
        break;
    case ARGUMENT_PLUS:
        reply_char(reply, right_letter(axis));
        break;
    case ARGUMENT_MINUS:
        reply_char(reply, status_limit_letter(axis));
        break;
    default:
        reply_integer(reply, status_byte(axis));
        break;
    }
}

static enum status rdstat(const struct request *request, struct reply *reply)
{
    enum argument_kind last = ARGUMENT_BARE;

    reply_text(reply, ":A");
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        if (argument == NULL)
            continue;
        /* Letters of one kind stand together: hosts take the n-th for the n-th axis. */
        if (argument->kind == ARGUMENT_BARE || argument->kind != last)
            reply_char(reply, ' ');
        print_state(reply, axis, argument->kind);
        last = argument->kind;
    }
    return STATUS_OK;
}

static enum status rdsbyte(const struct request *request, struct reply *reply)
{
    reply_char(reply, ':');
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (request_argument(request, axis_letter(axis)) != NULL)
            reply_char(reply, (char)status_byte(axis));
    return STATUS_OK;
}

static double get_enabled(unsigned axis)
{
    return motion_enabled(axis);
}

static enum status sign_enabled(unsigned axis, bool plus, bool act)
{
    if (plus && interlock_is_blocked(axis))
        return STATUS_FAILED;
    if (act)
        motion_enable(axis, plus);
    return STATUS_OK;
}

/* MC takes signs only; a bare letter must not switch an axis off. */
static enum status no_value(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    return STATUS_RANGE;
}

/* Not of the original: what the servo costs. */
static enum status tick(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, ":A ");
    reply_integer(reply, (int32_t)axis_tick_cycles());
    reply_char(reply, ' ');
    reply_integer(reply, (int32_t)axis_tick_cycles_max());
    return STATUS_OK;
}

static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        motion_enable(axis, true);
}

static const struct parameter parameters[] = {
    {
        .command = "MOTCTRL", .letter = PARAMETER_AXES, .type = PARAMETER_INTEGER,
        .summary = "1: the axis is driven. + and - switch it on and off.",
        .minimum = 0, .maximum = 1, .initial = 1, .saved = SAVED_NEVER,
        .check = no_value, .get = get_enabled, .sign = sign_enabled,
    },
    {0},
};

static const struct command commands[] = {
    {.name = "STATUS", .shortcut = "/", .flags = COMMAND_ASKS, .summary = "B while a commanded motion runs, else N.",
     .run = status, .accepts = ARGUMENT_BARE, .letters = LETTERS_ALL},
    {.name = "RDSTAT", .shortcut = "RS", .summary = "State of axes: byte, ? busy, - and + letters.",
     .flags = COMMAND_NEEDS_ARGUMENT | COMMAND_ASKS, .run = rdstat,
     .accepts = ARGUMENT_BARE | ARGUMENT_QUERY | ARGUMENT_PLUS | ARGUMENT_MINUS},
    {.name = "RDSBYTE", .shortcut = "RB", .summary = "State of axes as raw bytes.",
     .flags = COMMAND_NEEDS_ARGUMENT | COMMAND_ASKS, .run = rdsbyte, .accepts = ARGUMENT_BARE},
    {.name = "MOTCTRL", .shortcut = "MC", .summary = "Drive of axes on and off.",
     .form = FORM_VALUES},
    {.name = "TICK", .summary = "Processor clocks of the servo interrupt: last and longest.",
     .run = tick},
    {0},
};

const struct module status_module = {
    .name = "status",
    .commands = commands,
    .parameters = parameters,
    .init = init,
};
