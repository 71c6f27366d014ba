/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/identity.h"

#include <stddef.h>

#include "config.h"
#include "modules/update.h"

/* Of fixed size, so that no other code or data stand elsewhere, nor take other times, for a longer version. */
static const char own_version[40] = ABBE_VERSION, build_date[24] = ABBE_DATE;
_Static_assert(sizeof ABBE_VERSION <= sizeof own_version && sizeof ABBE_DATE <= sizeof build_date, "too long");

/* What BU Y gathers: characters of a text, kept in doubles of seven characters of 7 bits each. */
enum { TEXT_MAX = 20, TEXT_PART = 7, TEXT_PARTS = 3 };
static double text_parts[TEXT_PARTS];

#define TEXT_PART_MAX 562949953421311.0 /* 2^49 - 1 */

/* BU Z. */
#define SCRATCH_MAX 65535.0
static double scratch;

/*
 * The version reported is the level of the language that hosts ask for: it switches their features
 * on and off. It is a setting, because one of them accepts "9.2k" only. Who we are is in WHO.
 */
static double minor_digit, revision_character;

static enum status version(const struct request *request, struct reply *reply)
{
    if (request_argument(request, 'T') != NULL) {
        reply_text(reply, ":A v" LANGUAGE_LEVEL);
        return STATUS_OK;
    }
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
    reply_text(reply, "-Abbe-");
    reply_text(reply, own_version);
    return STATUS_OK;
}

static enum status date(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, build_date);
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
        reply_text(reply, "BootLdr V:");
        reply_integer(reply, (int32_t)update_boot_version());
        break;
    case BUILD_HARDWARE:
        reply_text(reply, "Hdwr REV." HARDWARE_REVISION);
        break;
    default:
        reply_text(reply, module_line(n - BUILD_MODULES));
        break;
    }
}

/* The n-th character of the user's text, 0 beyond its end. */
static char text_character(unsigned n)
{
    return (char)((uint64_t)text_parts[n / TEXT_PART] >> (7 * (n % TEXT_PART)) & 0x7f);
}

static unsigned text_length(void)
{
    unsigned length = 0;

    while (length < TEXT_MAX && text_character(length) != 0)
        length++;
    return length;
}

static void text_clear(void)
{
    for (unsigned part = 0; part < TEXT_PARTS; part++)
        text_parts[part] = 0;
}

/* BU Y: =n appends a character, - clears, ? prints. */
static enum status build_text(const struct argument *argument, struct reply *reply)
{
    const unsigned length = text_length();

    switch (argument->kind) {
    case ARGUMENT_QUERY:
        reply_text(reply, ":A ");
        for (unsigned n = 0; n < length; n++)
            reply_char(reply, text_character(n));
        return STATUS_OK;
    case ARGUMENT_MINUS:
        text_clear();
        return STATUS_OK;
    case ARGUMENT_VALUE:
        if (!(argument->value >= 32 && argument->value <= 126))
            return STATUS_RANGE;
        if (length == TEXT_MAX)
            return STATUS_FAILED;
        text_parts[length / TEXT_PART] +=
            (double)((uint64_t)argument->value << (7 * (length % TEXT_PART)));
        return STATUS_OK;
    default:
        return STATUS_RANGE;
    }
}

/* X names the list and Y the text; X takes no value. */
static enum status check_build(const struct request *request)
{
    const struct argument *list = request_argument(request, 'X');
    const struct argument *text = request_argument(request, 'Y');

    if (list != NULL && (list->kind != ARGUMENT_BARE || text != NULL))
        return STATUS_RANGE;
    return STATUS_OK;
}

/* One line each time it is called: the list has no upper bound, a reply's text has one. */
static enum status build(const struct request *request, struct reply *reply)
{
    const struct argument *text = request_argument(request, 'Y');

    if (text != NULL)
        return build_text(text, reply);
    write_build_line(reply, reply->step);
    if (request->count == 0)
        return STATUS_OK;
    reply->step++;
    if (reply->step >= BUILD_MODULES && module_line(reply->step - BUILD_MODULES) == NULL)
        return STATUS_OK;
    reply_end_line(reply);
    return STATUS_PENDING;
}

static enum status step_scratch(unsigned axis, bool plus, bool act)
{
    (void)axis;
    if (act && plus)
        scratch = scratch < SCRATCH_MAX ? scratch + 1 : 0;
    else if (act)
        scratch = scratch > 0 ? scratch - 1 : SCRATCH_MAX;
    return STATUS_OK;
}

static const struct command commands[] = {
    {
        .name = "VERSION", .shortcut = "V", .form = FORM_P, .run = version,
        .accepts = ARGUMENT_BARE, .letters = "T",
        .summary = "Level of the command language, as hosts know it.",
    },
    {
        .name = "WHO", .shortcut = "N", .run = who,
        .summary = "Name of the controller, axes fitted and our own version.",
    },
    {
        .name = "BUILD", .shortcut = "BU", .run = build, .check = check_build,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_QUERY | ARGUMENT_MINUS,
        .letters = "XY", .form = FORM_VALUES,
        .summary = "Name of the build; BU X lists axes and modules. BU Y=n appends character n to "
                   "a text of 20, BU Y- clears it, BU Y? prints it.",
    },
    {
        .name = "CDATE", .shortcut = "CD", .run = date, .summary = "Date of the firmware.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "VERSION", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 9, .initial = 2, .value = &minor_digit, .saved = SAVED_BY_SS,
        .summary = "Minor digit of the version reported, the 2 of 9.2k.",
    },
    {
        .command = "VERSION", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = '0', .maximum = 'z', .initial = 'k', .value = &revision_character,
        .check = check_revision, .saved = SAVED_BY_SS,
        .summary = "Revision of the version reported, as a character code: the k of 9.2k is 107.",
    },
    {
        .command = "BUILD", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = SCRATCH_MAX, .initial = 0, .value = &scratch,
        .sign = step_scratch, .saved = SAVED_NEVER,
        .summary = "A number for the host's use, 0 after a start; + and - count and wrap.",
    },
    /* Letters that cannot be typed: rows for the settings only. */
    {
        .command = "BUILD", .letter = '1', .type = PARAMETER_INTEGER, .minimum = 0,
        .maximum = TEXT_PART_MAX, .value = &text_parts[0], .saved = SAVED_BY_SS,
        .summary = "Characters 1 to 7 of the text.",
    },
    {
        .command = "BUILD", .letter = '2', .type = PARAMETER_INTEGER, .minimum = 0,
        .maximum = TEXT_PART_MAX, .value = &text_parts[1], .saved = SAVED_BY_SS,
        .summary = "Characters 8 to 14 of the text.",
    },
    {
        .command = "BUILD", .letter = '3', .type = PARAMETER_INTEGER, .minimum = 0,
        .maximum = TEXT_PART_MAX, .value = &text_parts[2], .saved = SAVED_BY_SS,
        .summary = "Characters 15 to 20 of the text.",
    },
    {0},
};

const struct module identity_module = {
    .name = "identity", .commands = commands, .parameters = parameters,
};
