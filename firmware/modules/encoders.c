/* SPDX-License-Identifier: BSD-2-Clause */
/* Which way an encoder counts. What it does wrong is found by the gateware: modules/interlock.c. */
#include "modules/encoders.h"

#include "core/axis.h"
#include "hal/encoder.h"

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
    .name = "encoders", .commands = commands, .parameters = parameters,
};
