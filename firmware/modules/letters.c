/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/letters.h"

#include <stddef.h>

/* As Z2B gave them, character codes. They are the axes' letters from the next start on. */
static double codes[AXIS_COUNT];

unsigned letters_focus_axis(void)
{
    return AXIS_COUNT > 2 ? 2 : AXIS_COUNT - 1;
}

static double initial_code(unsigned axis)
{
    return AXIS_LETTERS[axis];
}

/* No other axis may have the letter, now or after the next start. */
static enum status check_code(unsigned axis, double value)
{
    for (unsigned other = 0; other < AXIS_COUNT; other++)
        if (other != axis && (codes[other] == value || axis_letter(other) == (char)value))
            return STATUS_RANGE;
    return STATUS_OK;
}

/* Hosts compare it with UNLOCK F. */
static double get_index(unsigned axis)
{
    return axis;
}

static double get_focus(unsigned axis)
{
    (void)axis;
    return letters_focus_axis();
}

static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        axis_set_letter(axis, (char)codes[axis]);
}

static const struct command commands[] = {
    {
        .name = "Z2B", .form = FORM_P,
        .summary = "Another letter for an axis, from the next start on.",
    },
    {
        .name = "UNLOCK", .shortcut = "UL", .form = FORM_P, .summary = "Which axis focuses.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "Z2B", .letter = PARAMETER_AXES, .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 'A', .maximum = 'Z', .initial_of = initial_code, .value = codes,
        .check = check_code,
        .taken = "codes of A to Z that no axis has", .get = get_index, .saved = SAVED_BY_SS,
        .summary = "Set: the letter's character code, 66 for B. Query: number of the axis, from 0.",
    },
    {
        .command = "UNLOCK", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = AXIS_COUNT - 1, .read_only = true, .get = get_focus,
        .saved = SAVED_NEVER, .summary = "Number of the axis that focuses, from 0.",
    },
    {0},
};

const struct module letters_module = {
    .name = "letters", .commands = commands, .parameters = parameters, .init = init,
};
