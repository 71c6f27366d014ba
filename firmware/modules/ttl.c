/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/ttl.h"

#include <stddef.h>

#include "modules/pins.h"

static double in0_mode, out0_mode, polarity;

static enum status ttl(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, pins_out0_level() ? ":A 1" : ":A 0");
    return STATUS_OK;
}

static void set_in0_mode(unsigned axis, double mode)
{
    (void)axis;
    pins_enable_pixels(mode == 1);
}

static void set_out0_mode(unsigned axis, double mode)
{
    (void)axis;
    pins_out0(mode == 1);
}

static enum status check_polarity(unsigned axis, double value)
{
    (void)axis;
    return value == 1 || value == -1 ? STATUS_OK : STATUS_RANGE;
}

static void set_polarity(unsigned axis, double value)
{
    (void)axis;
    pins_invert(value < 0);
}

static const struct command commands[] = {
    {
        .name = "TTL", .form = FORM_P, .run = ttl,
        .summary = "Modes of the TTL connectors; without arguments the level of OUT0.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "TTL", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &in0_mode, .set = set_in0_mode,
        .saved = SAVED_BY_SS,
        .summary = "IN0: 0 off; 1 the encoder interrupt: the pixels of a scan give pulses.",
    },
    {
        .command = "TTL", .letter = 'Y', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 1, .value = &out0_mode, .set = set_out0_mode,
        .saved = SAVED_BY_SS, .summary = "OUT0: 0 low, 1 high.",
    },
    {
        .command = "TTL", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = -1, .maximum = 1, .initial = 1, .value = &polarity, .check = check_polarity,
        .set = set_polarity, .saved = SAVED_BY_SS,
        .summary = "Polarity of OUT0 and of the pixel pulses: 1 as is, -1 inverted.",
    },
    {0},
};

const struct module ttl_module = {
    .name = "ttl", .commands = commands, .parameters = parameters,
};
