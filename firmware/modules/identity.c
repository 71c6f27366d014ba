/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/identity.h"

#include <stddef.h>

#include "config.h"

/*
 * The version reported is the level of the language that hosts ask for: it switches their features
 * on and off. It is a setting, because one of them accepts "9.2k" only. Who we are is in WHO.
 */
static double minor_digit, revision_character;

static enum status version(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, ":A Version: USB-9.");
    reply_integer(reply, (int32_t)minor_digit);
    reply_char(reply, (char)revision_character);
    reply_char(reply, ' ');
    return STATUS_OK;
}

static enum status check_revision(unsigned axis, double value)
{
    bool digit = value >= '0' && value <= '9', letter = value >= 'a' && value <= 'z';

    (void)axis;
    return digit || letter ? STATUS_OK : STATUS_RANGE;
}

static enum status who(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, ":A ASI-MS2000-");
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        reply_char(reply, axis_letter(axis));
    reply_text(reply, "-Abbe-" ABBE_VERSION);
    return STATUS_OK;
}

static enum status date(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, ABBE_DATE);
    return STATUS_OK;
}

/* The n-th of the lines that modules add to BUILD X, or NULL. */
static const char *module_line(unsigned n)
{
    for (const struct module *const *module = command_modules(); *module != NULL; module++) {
        const char *const *line = (*module)->build_lines;

        for (; line != NULL && *line != NULL; line++)
            if (n-- == 0)
                return *line;
    }
    return NULL;
}

enum build_line {
    BUILD_NAME,
    BUILD_AXES,
    BUILD_LETTERS,
    BUILD_BOOT,
    BUILD_HARDWARE,
    BUILD_MODULES, /* and one more for each further line */
};

static void write_build_line(struct reply *reply, unsigned n)
{
    switch (n) {
    case BUILD_NAME:
        reply_text(reply, "ABBE_");
        for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
            reply_char(reply, axis_letter(axis));
        break;
    case BUILD_AXES:
        /* Hosts count on one blank between letters and two at the end. */
        reply_text(reply, "Motor Axes: ");
        for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
            reply_char(reply, axis_letter(axis));
            reply_char(reply, ' ');
        }
        reply_char(reply, ' ');
        break;
    case BUILD_LETTERS:
        reply_text(reply, "CMDs: XYZFTR");
        break;
    case BUILD_BOOT:
        reply_text(reply, "BootLdr V:" BOOT_LOADER_VERSION);
        break;
    case BUILD_HARDWARE:
        reply_text(reply, "Hdwr REV." HARDWARE_REVISION);
        break;
    default:
        reply_text(reply, module_line(n - BUILD_MODULES));
        break;
    }
}

/* One line each time it is called: the list has no upper bound, a reply's text has one. */
static enum status build(const struct request *request, struct reply *reply)
{
    write_build_line(reply, reply->step);
    if (request->count == 0)
        return STATUS_OK;
    reply->step++;
    if (reply->step >= BUILD_MODULES && module_line(reply->step - BUILD_MODULES) == NULL)
        return STATUS_OK;
    reply_end_line(reply);
    return STATUS_PENDING;
}

static const struct command commands[] = {
    {
        .name = "VERSION", .shortcut = "V", .form = FORM_P, .run = version,
        .summary = "Level of the command language, as hosts know it.",
    },
    {
        .name = "WHO", .shortcut = "N", .run = who,
        .summary = "Name of the controller, axes fitted and our own version.",
    },
    {
        .name = "BUILD", .shortcut = "BU", .run = build, .accepts = ARGUMENT_BARE, .letters = "X",
        .summary = "Name of the build; BU X lists axes and modules.",
    },
    {
        .name = "CDATE", .shortcut = "CD", .run = date, .summary = "Date of the firmware.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "VERSION", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 9, .initial = 2, .value = &minor_digit,
        .summary = "Minor digit of the version reported, the 2 of 9.2k.",
    },
    {
        .command = "VERSION", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = '0', .maximum = 'z', .initial = 'k', .value = &revision_character,
        .check = check_revision,
        .summary = "Revision of the version reported, as a character code: the k of 9.2k is 107.",
    },
    {0},
};

const struct module identity_module = {
    .name = "identity", .commands = commands, .parameters = parameters,
};
