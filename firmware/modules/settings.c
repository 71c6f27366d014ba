/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/settings.h"

#include <stddef.h>
#include <string.h>

#include "core/settings.h"

static bool act(char letter)
{
    switch (letter) {
    case 'X':
        return settings_factory_next();
    case 'Y':
        return settings_restore();
    default:
        return settings_save();
    }
}

enum step { STEP_BEGIN, STEP_ACT, STEP_KEEP };

/*
 * The letter says what to do, so exactly one is wanted; with more the line is refused. The colon
 * leaves at once, the A when it is done; a failure then reads :N-5.
 */
static enum status saveset(const struct request *request, struct reply *reply)
{
    const char letter = request->arguments[0].letter;
    bool done;

    if (request->count != 1 || strchr("XYZ", letter) == NULL)
        return STATUS_RANGE;
    switch (reply->step) {
    case STEP_BEGIN:
        reply_char(reply, ':');
        reply->step = STEP_ACT;
        return STATUS_PENDING;
    case STEP_ACT:
        done = act(letter);
        if (done && settings_pending()) {
            reply->step = STEP_KEEP;
            return STATUS_PENDING;
        }
        break;
    default:
        if (settings_pending())
            return STATUS_PENDING;
        done = true;
        break;
    }
    reply_text(reply, done && settings_kept() ? "A " : "N-5");
    return STATUS_OK;
}

static const struct command commands[] = {
    {
        .name = "SAVESET", .shortcut = "SS", .run = saveset, .flags = COMMAND_NEEDS_ARGUMENT,
        .accepts = ARGUMENT_BARE, .letters = LETTERS_ALL,
        .summary = "Z saves the settings, Y restores them, X: factory values at the next start.",
    },
    {0},
};

const struct module settings_module = {
    .name = "settings", .commands = commands,
};
