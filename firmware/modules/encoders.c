/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * An illegal transition says that counts were lost: the axis is stopped and switched off, as one that
 * does not obey, and 24 is logged. MC axis+ takes it back; where it is, its user must find out.
 *
 * A wire that breaks makes no illegal transition. The count then stands still, and the loop finds a
 * dead axis (servo/loop.c).
 */
#include "modules/encoders.h"

#include <stddef.h>

#include "core/axis.h"
#include "core/fault.h"
#include "hal/encoder.h"
#include "modules/motion.h"

static double polarity[AXIS_COUNT];

static enum status check(unsigned axis, double value)
{
    (void)axis;
    return value != 0 ? STATUS_OK : STATUS_RANGE;
}

static void set(unsigned axis, double value)
{
    encoder_configure(axis, 0, value < 0);
}

/* What the pins did before the start is no fault. */
static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        (void)encoder_take_error(axis);
}

/* One axis a turn. */
static void poll(void)
{
    static unsigned axis;

    axis = (axis + 1) % AXIS_COUNT;
    if (!encoder_take_error(axis))
        return;
    log_error(FAULT_ENCODER);
    motion_enable(axis, false);
}

static const struct parameter parameters[] = {
    {
        .command = "EPOLARITY", .letter = PARAMETER_AXES, .type = PARAMETER_INTEGER,
        .summary = "1, or -1 to count the other way round; that of the motor's drive stays.",
        .minimum = -1, .maximum = 1, .initial = 1, .saved = SAVED_BY_SS, .value = polarity,
        .check = check, .set = set,
    },
    {0},
};

static const struct command commands[] = {
    {.name = "EPOLARITY", .shortcut = "EP", .summary = "Directions of encoders.", .form = FORM_P},
    {0},
};

const struct module encoders_module = {
    .name = "encoders", .commands = commands, .parameters = parameters, .init = init, .poll = poll,
};
