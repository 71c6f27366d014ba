/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/low_level.h"

#include <math.h>
#include <stddef.h>

#include "core/axis.h"
#include "modules/coordinates.h"
#include "modules/lookup.h"
#include "modules/motion.h"
#include "modules/move.h"
#include "modules/status.h"

enum {
    FIRST_ADDRESS = 24,
    PLACE_BYTES = 3,
    PLACE_MAX = 0x7fffff, /* tenths of a micron */
};

#define TENTHS_PER_MM 1e4

static const struct motion_owner owner = {.name = "low level", .busy = true, .letter = 'B'};

static double addresses[AXIS_COUNT];
static int32_t increments[AXIS_COUNT]; /* tenths of a micron */

uint8_t low_level_address(unsigned axis)
{
    return (uint8_t)addresses[axis];
}

/* Two's complement, least significant byte first. */
static int32_t read_place(const uint8_t *frame)
{
    uint32_t value = 0;
    unsigned size = frame[2];

    for (unsigned i = 0; i < size; i++)
        value |= (uint32_t)frame[3 + i] << (8 * i);
    if (size > 0 && size < 4 && (value >> (8 * size - 1) & 1u) != 0)
        value |= UINT32_MAX << (8 * size);
    return (int32_t)value;
}

static void write_place(struct reply *reply, double tenths)
{
    tenths = fmin(fmax(tenths, -PLACE_MAX - 1), PLACE_MAX);
    uint32_t value = (uint32_t)(int32_t)lround(tenths);

    for (unsigned i = 0; i < PLACE_BYTES; i++)
        reply_char(reply, (char)(value >> (8 * i) & 0xff));
}

static double position_tenths(unsigned axis)
{
    return TENTHS_PER_MM * coordinates_counts_to_mm(axis, motion_position_counts(axis));
}

static void move_counts(unsigned axis, int32_t counts)
{
    int32_t targets[AXIS_COUNT] = {0};

    targets[axis] = counts;
    (void)move_to(&owner, MOTION_AXIS(axis), targets); /* the format has no answer for a refusal */
}

/* `tenths` from where the axis is or will be. */
static void move_by(unsigned axis, double tenths)
{
    double target = coordinates_counts_to_mm(axis, motion_target_counts(axis));

    move_counts(axis, coordinates_mm_to_counts(axis, target + tenths / TENTHS_PER_MM));
}

/* As J axis+ and J axis-, if there is a joystick. */
static void connect_joystick(unsigned axis, bool connect)
{
    const struct parameter *row = lookup_parameter("JOYSTICK", axis);

    if (row != NULL && row->sign != NULL)
        (void)row->sign(axis, connect, true);
}

static void carry_out(unsigned axis, const uint8_t *frame, struct reply *reply)
{
    switch (frame[1]) {
    case '?':
        reply_char(reply, motion_axis_busy(axis) ? 'B' : 'b');
        break;
    case 'T':
        move_counts(axis, coordinates_mm_to_counts(axis, read_place(frame) / TENTHS_PER_MM));
        break;
    case 'a':
        write_place(reply, position_tenths(axis));
        break;
    case 'l':
        write_place(reply, position_tenths(axis));
        reply_char(reply, (char)status_byte(axis));
        break;
    case '~':
        reply_char(reply, (char)status_byte(axis));
        break;
    case 'D':
        increments[axis] = read_place(frame);
        break;
    case 'd':
        write_place(reply, increments[axis]);
        break;
    case '+':
        move_by(axis, increments[axis]);
        break;
    case '-':
        move_by(axis, -(double)increments[axis]);
        break;
    case 'G':
        motion_enable(axis, true);
        break;
    case 'B':
        motion_stop(MOTION_AXIS(axis));
        break;
    case 'J':
    case 'K':
        connect_joystick(axis, frame[1] == 'J');
        break;
    default: /* speed and ramp time of another maker's set are taken and ignored */
        break;
    }
}

static bool run_frame(const uint8_t *frame, struct reply *reply)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (low_level_address(axis) == frame[0]) {
            carry_out(axis, frame, reply);
            return true;
        }
    }
    return false;
}

static double initial_address(unsigned axis)
{
    return FIRST_ADDRESS + axis;
}

/* A number is one axis': of the line as a whole, in which two may change theirs. */
static enum status check_addresses(const struct request *request)
{
    int32_t wanted[AXIS_COUNT];

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        wanted[axis] = argument == NULL || argument->kind == ARGUMENT_QUERY
                           ? (int32_t)addresses[axis]
                           : (int32_t)argument->value;
        for (unsigned other = 0; other < axis; other++)
            if (wanted[other] == wanted[axis])
                return STATUS_RANGE;
    }
    return STATUS_OK;
}

static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        increments[axis] = 0;
}

static const struct command commands[] = {
    {
        .name = "LLADDR", .shortcut = "LL", .form = FORM_P, .check = check_addresses,
        .summary = "Numbers of axes in the low-level format, all different.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "LLADDR", .letter = PARAMETER_AXES, .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 254, .initial_of = initial_address, .value = addresses,
        .saved = SAVED_BY_SS, .summary = "Number of the axis in low-level frames; 24 is X.",
    },
    {0},
};

static const char *const build_lines[] = {"LL COMMANDS", NULL};

const struct module low_level_module = {
    .name = "low level", .commands = commands, .parameters = parameters,
    .build_lines = build_lines, .frame = run_frame, .init = init,
};
