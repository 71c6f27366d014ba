/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/verbose.h"

#include <stddef.h>

#include "core/action.h"
#include "core/report.h"
#include "hal/inputs.h"
#include "modules/motion.h"
#include "modules/positions.h"

/* Bits of VB X. */
enum {
    SAY_MOVE_END = 1,   /* N */
    SAY_JOYSTICK = 2,   /* p short press, P long press */
    SAY_IN1 = 4,        /* H and L at its edges */
    SHORT_END = 8,      /* lines end in CR alone */
    PRINT_TARGETS = 16, /* MOVE and MOVREL answer with the new targets */
    SAY_POSITIONS = 32, /* as WHERE does, at the end of a move */
    BITS_ALL = 63,
};

static double bits;

static bool wants(unsigned bit)
{
    return ((unsigned)bits & bit) != 0;
}

bool verbose_prints_targets(void)
{
    return wants(PRINT_TARGETS);
}

static void set_bits(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    reply_ends_in_cr = wants(SHORT_END);
}

static bool read_in1(void)
{
    struct inputs inputs;

    inputs_read(&inputs);
    return inputs.in1;
}

static double get_in1(unsigned axis)
{
    (void)axis;
    return read_in1();
}

/* STATUS goes from B to N: whatever ended the move. */
static void busy_changed(const struct event *event)
{
    if (event->argument != 0)
        return;
    if (wants(SAY_MOVE_END))
        report_line("N", 1);
    if (wants(SAY_POSITIONS))
        positions_report(MOTION_AXES_ALL);
}

static void pressed(const struct event *event)
{
    if (!wants(SAY_JOYSTICK))
        return;
    if (event->argument == ACTION_JOYSTICK_SHORT)
        report_line("p", 1);
    else if (event->argument == ACTION_JOYSTICK_LONG ||
             event->argument == ACTION_JOYSTICK_EXTRA_LONG)
        report_line("P", 1);
}

static void in1_changed(const struct event *event)
{
    if (wants(SAY_IN1))
        report_line(event->argument != 0 ? "H" : "L", 1);
}

static void init(void)
{
    report_clear();
}

static const struct command commands[] = {
    {
        .name = "VB", .form = FORM_P,
        .summary = "What is said without being asked, and the forms of replies.",
    },
    {0},
};

static double syntax;

static const struct parameter parameters[] = {
    {
        .command = "VB", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "bits",
        .minimum = 0, .maximum = BITS_ALL, .initial = 0, .value = &bits, .set = set_bits,
        .saved = SAVED_BY_SS,
        .summary = "1: N at the end of a move; 2: p and P at joystick presses; 4: H and L at edges "
                   "of IN1; 8: lines end in CR alone; 16: moves answer with their targets; "
                   "32: positions at the end of a move.",
    },
    {
        .command = "VB", .letter = 'Y', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .read_only = true, .get = get_in1, .saved = SAVED_NEVER,
        .summary = "Level of the TTL input IN1.",
    },
    {
        .command = "VB", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "digits",
        .minimum = 0, .maximum = 9, .initial = 1, .value = &reply_position_decimals,
        .summary = "Decimals of the positions WHERE prints.",
    },
    {
        .command = "VB", .letter = 'F', .type = PARAMETER_INTEGER, .minimum = 0, .maximum = 0,
        .value = &syntax, .saved = SAVED_NEVER,
        .summary = "Syntax of replies: 0, that of the MS-2000, is the only one.",
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_BUSY, EVENT_IN_MAIN, busy_changed},
    {EVENT_BUTTON, EVENT_IN_MAIN, pressed},
    {EVENT_IN1, EVENT_IN_MAIN, in1_changed},
    {0},
};

const struct module verbose_module = {
    .name = "verbose",
    .commands = commands,
    .parameters = parameters,
    .subscriptions = subscriptions,
    .init = init,
};
