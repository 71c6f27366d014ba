/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/buttons.h"

#include <stddef.h>
#include <string.h>

#include "core/action.h"
#include "core/axis.h"
#include "core/events.h"
#include "hal/buttons.h"
#include "modules/inputs.h"
#include "modules/joystick.h"

/* What a press can do: the numbers of BCUSTOM. Others belong to modules that are not built. */
enum function {
    FUNCTION_NONE = 0,
    FUNCTION_TOGGLE_KNOB = 2, /* between two axes */
    FUNCTION_OWN = 3,         /* what the button and the class of the press are there for */
};

/* Bits of BENABLE Z. */
enum { ENABLE_ZERO = 1, ENABLE_HOME = 2, ENABLE_AT = 4, ENABLE_JOYSTICK = 8, ZERO_ONLY_Z = 32 };
enum { ENABLE_ALL = 15, BITS_MAX = 255 };

static const struct {
    unsigned enable;
    enum action actions[BUTTON_LENGTHS];
} buttons[BUTTON_COUNT] = {
    [BUTTON_AT] = {ENABLE_AT, {ACTION_AT_SHORT, ACTION_AT_LONG, ACTION_AT_EXTRA_LONG}},
    [BUTTON_HOME] = {ENABLE_HOME, {ACTION_HOME_SHORT, ACTION_HOME_LONG, ACTION_HOME_EXTRA_LONG}},
    [BUTTON_ZERO] = {ENABLE_ZERO, {ACTION_ZERO_SHORT, ACTION_ZERO_LONG, ACTION_ZERO_EXTRA_LONG}},
    [BUTTON_JOYSTICK] = {ENABLE_JOYSTICK, {ACTION_JOYSTICK_SHORT, ACTION_JOYSTICK_LONG,
                                           ACTION_JOYSTICK_EXTRA_LONG}},
};

static double enabled;
static double at_functions[BUTTON_LENGTHS], home_functions[BUTTON_LENGTHS];
static double zero_functions[BUTTON_LENGTHS], joystick_functions[BUTTON_LENGTHS];

static double *const functions[BUTTON_COUNT] = {
    [BUTTON_AT] = at_functions, [BUTTON_HOME] = home_functions,
    [BUTTON_ZERO] = zero_functions, [BUTTON_JOYSTICK] = joystick_functions,
};

/* --- Presses ---------------------------------------------------------------------------------- */

static void perform(enum function function, enum action action)
{
    if (function == FUNCTION_TOGGLE_KNOB)
        joystick_toggle_knob();
    else if (function == FUNCTION_OWN)
        (void)action_perform(action);
}

static void poll(void)
{
    for (unsigned n = 0; n < BUTTON_COUNT; n++) {
        struct button_press press;
        enum action action;

        if (!buttons_take((enum button)n, &press) || ((unsigned)enabled & buttons[n].enable) == 0)
            continue;
        action = buttons[n].actions[press.length];
        events_publish(EVENT_BUTTON, action, inputs_time_fast(press.at_cycles));
        perform((enum function)functions[n][press.length], action);
    }
}

/* Do what a line does. Its reply goes nowhere. */
static bool carry_out(const char *line)
{
    static struct request request;
    static struct reply reply;

    reply_clear(&reply);
    return command_execute(line, strlen(line), &request, &reply) == STATUS_OK;
}

bool buttons_home(void)
{
    char line[8 + AXIS_COUNT] = "HOME ";
    size_t length = strlen(line);

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        line[length++] = axis_letter(axis);
    line[length] = '\0';
    return carry_out(line);
}

bool buttons_zero(void)
{
    return carry_out(((unsigned)enabled & ZERO_ONLY_Z) != 0 ? "HERE Z=0" : "ZERO");
}

/* --- Settings --------------------------------------------------------------------------------- */

static enum status check_function(unsigned axis, double value)
{
    (void)axis;
    return value == FUNCTION_NONE || value == FUNCTION_TOGGLE_KNOB || value == FUNCTION_OWN
               ? STATUS_OK
               : STATUS_RANGE;
}

static void set_all(unsigned axis, double value)
{
    (void)axis;
    enabled = value != 0 ? ENABLE_ALL : 0;
}

static double get_enabled(unsigned axis)
{
    (void)axis;
    return enabled;
}

/* As if a button with this function had been pressed shortly: the @ button, if it is its own. */
static void simulate(unsigned axis, double value)
{
    (void)axis;
    perform((enum function)value, ACTION_AT_SHORT);
}

static double nothing(unsigned axis)
{
    (void)axis;
    return 0;
}

static void init(void)
{
    buttons_clear();
}

#define FUNCTION                                                                                   \
    .type = PARAMETER_INTEGER, .unit = "", .minimum = 0, .maximum = BITS_MAX,                      \
    .initial = FUNCTION_OWN, .check = check_function

static const struct parameter parameters[] = {
    /* X before Z: what is saved of Z is what holds. */
    {
        .command = "BENABLE", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 1, .set = set_all, .get = get_enabled,
        .saved = SAVED_NEVER, .summary = "1: all buttons work; 0: none. A query answers as Z.",
    },
    {
        .command = "BENABLE", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "bits",
        .minimum = 0, .maximum = BITS_MAX, .initial = ENABLE_ALL, .value = &enabled,
        .saved = SAVED_BY_SS,
        .summary = "Buttons that work: 1 ZERO, 2 HOME, 4 @, 8 joystick; 32: ZERO is for Z alone.",
    },
    {
        .command = "BENABLE", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = BITS_MAX, .initial = 0, .check = check_function, .set = simulate,
        .get = nothing, .saved = SAVED_NEVER, .summary = "Does what a press of that function does.",
    },
    {
        .command = "BENABLE", .letter = 'R', FUNCTION, .value = &home_functions[BUTTON_SHORT],
        .saved = SAVED_BY_SS, .summary = "Function of HOME, pressed shortly, as BCUSTOM.",
    },
    {
        .command = "BENABLE", .letter = 'T', FUNCTION,
        .value = &joystick_functions[BUTTON_EXTRA_LONG],
        .saved = SAVED_BY_SS, .summary = "Function of the joystick button, extra long.",
    },
    {
        .command = "BENABLE", .letter = 'M', FUNCTION, .value = &zero_functions[BUTTON_SHORT],
        .saved = SAVED_BY_SS, .summary = "Function of ZERO, pressed shortly.",
    },
    {
        .command = "BCUSTOM", .letter = 'X', FUNCTION, .value = &at_functions[BUTTON_SHORT],
        .saved = SAVED_AT_ONCE,
        .summary = "Function of @, pressed shortly: 0 none, 2 toggles the knob between two axes, "
                   "3 the button's own.",
    },
    {
        .command = "BCUSTOM", .letter = 'Y', FUNCTION, .value = &at_functions[BUTTON_LONG],
        .saved = SAVED_AT_ONCE, .summary = "Function of @, long: 1 s and more.",
    },
    {
        .command = "BCUSTOM", .letter = 'Z', FUNCTION, .value = &at_functions[BUTTON_EXTRA_LONG],
        .saved = SAVED_AT_ONCE, .summary = "Function of @, extra long: 3 s and more.",
    },
    {
        .command = "BCUSTOM", .letter = 'F', FUNCTION, .value = &home_functions[BUTTON_LONG],
        .saved = SAVED_AT_ONCE, .summary = "Function of HOME, long.",
    },
    {
        .command = "BCUSTOM", .letter = 'T', FUNCTION, .value = &home_functions[BUTTON_EXTRA_LONG],
        .saved = SAVED_AT_ONCE, .summary = "Function of HOME, extra long.",
    },
    {
        .command = "BCUSTOM", .letter = 'R', FUNCTION, .value = &joystick_functions[BUTTON_SHORT],
        .saved = SAVED_AT_ONCE, .summary = "Function of the joystick button, pressed shortly.",
    },
    {
        .command = "BCUSTOM", .letter = 'M', FUNCTION, .value = &joystick_functions[BUTTON_LONG],
        .saved = SAVED_AT_ONCE, .summary = "Function of the joystick button, long.",
    },
    {0},
};

static const struct command commands[] = {
    {.name = "BENABLE", .shortcut = "BE", .form = FORM_P, .summary = "Which buttons work."},
    {.name = "BCUSTOM", .shortcut = "BCA", .form = FORM_P, .summary = "What buttons do."},
    {0},
};

const struct module buttons_module = {
    .name = "buttons",
    .commands = commands,
    .parameters = parameters,
    .init = init,
    .poll = poll,
};
