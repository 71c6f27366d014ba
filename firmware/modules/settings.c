/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/settings.h"

#include <stddef.h>

#include "core/settings.h"

/* The letter says what to do, so exactly one is wanted; with more the line is refused. */
static enum status saveset(const struct request *request, struct reply *reply)
{
    (void)reply;
    if (request->count != 1)
        return STATUS_RANGE;
    switch (request->arguments[0].letter) {
    case 'X':
        settings_factory_next();
        return STATUS_OK;
    case 'Y':
        settings_restore();
        return STATUS_OK;
    case 'Z':
        return settings_save() ? STATUS_OK : STATUS_FAILED;
    default:
        return STATUS_RANGE;
    }
}

static const struct command commands[] = {
    {
        .name = "SAVESET", .shortcut = "SS", .run = saveset, .flags = COMMAND_NEEDS_ARGUMENT,
        .accepts = ARGUMENT_BARE, .letters = LETTERS_ALL,
        .summary = "Z saves the settings, Y restores them, X: factory values at the next start.",
    },
    {
        .name = "VB", .form = FORM_P, .summary = "Forms of replies.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "VB", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "digits",
        .minimum = 0, .maximum = 9, .initial = 1, .value = &reply_position_decimals,
        .summary = "Decimals of the positions WHERE prints.",
    },
    {0},
};

const struct module settings_module = {
    .name = "settings", .commands = commands, .parameters = parameters,
};
