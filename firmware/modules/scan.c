/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/scan.h"

#include <stddef.h>

#include "modules/coordinates.h"
#include "modules/pins.h"
#include "modules/scan_run.h"

enum { AXIS_NONE = 9 }; /* as a value of the parameters below */

/* What the parameter rows hold. Pixels: 0 while the stop decides. */
static double start_mm, stop_mm, pitch_counts, pixels, retrace_percent, width_us, direct;
static double slow_start_mm, slow_stop_mm, lines, settle_ms, overshoot_mm, sync_axis, encoder_axis;
static double pattern, fast_axis, slow_axis, dialect;

/* An axis parameter as the line sets it, or as it is. */
static int axis_set(const struct request *request, char letter, double present)
{
    const struct argument *argument = request_argument(request, letter);

    return (int)(argument != NULL && argument->kind != ARGUMENT_QUERY ? argument->value : present);
}

/* What the words of one SCAN line come to. */
struct wish {
    enum { NOTHING, TOGGLE, START, STOP } action;
    int fast, slow; /* axis numbers or AXIS_NONE; the present ones when the line names none */
};

static int axis_or_none(double value)
{
    return value < AXIS_COUNT ? (int)value : SCAN_NO_AXIS;
}

/* The line as it stands, for the planner. */
static struct scan_settings line_settings(void)
{
    return (struct scan_settings){
        .start_mm = start_mm, .stop_mm = stop_mm, .pixels = (uint32_t)pixels,
        .pitch_counts = pitch_counts, .width_us = width_us, .settle_ms = settle_ms,
        .overshoot_mm = overshoot_mm,
    };
}

static struct scan_setup setup_of(const struct wish *wish)
{
    return (struct scan_setup){
        .line = line_settings(),
        .fast = axis_or_none(wish->fast), .slow = axis_or_none(wish->slow),
        .slow_start_mm = slow_start_mm, .slow_stop_mm = slow_stop_mm, .lines = (uint32_t)lines,
        .retrace_percent = retrace_percent, .serpentine = pattern != 0,
        .sync_axis = (int)sync_axis - 1, .encoder_axis = (int)encoder_axis - 1,
        .pulses = pins_pixels_enabled(),
    };
}

/* SYNC and ENCODER follow the fast axis unless jumpered; the direct output needs no scan. */
static void follow_fast_axis(void)
{
    int axis = (int)encoder_axis - 1;

    if (axis < 0)
        axis = axis_or_none(fast_axis);
    if (axis >= 0 && scan_run_state() == SCAN_IDLE)
        pins_encoder_axis((unsigned)axis);
}

/*
 * The dialect of the MS-2000 gives each of X, Y and Z a role: 1 fast, 2 slow, 0 not used. The other
 * one gives Y the number of the fast and Z that of the slow axis, 9 for none. A line that names X,
 * or holds a 2, can only be the first; one that holds a 9 only the second.
 */
static enum status take_roles(const struct request *request, struct wish *wish)
{
    const struct argument *given[3];
    int value[3] = {0, 0, 0};
    int named[3] = {AXIS_NONE, AXIS_NONE, AXIS_NONE}; /* axis of role 1 and of role 2 */
    bool two = false, nine = false;

    for (int n = 0; n < 3; n++) {
        given[n] = request_argument(request, "XYZ"[n]);
        if (given[n] != NULL && given[n]->kind == ARGUMENT_QUERY)
            given[n] = NULL;
        if (given[n] == NULL)
            continue;
        if (!(given[n]->value >= 0 && given[n]->value <= 99))
            return STATUS_RANGE;
        value[n] = (int)given[n]->value;
        two |= value[n] == 2;
        nine |= value[n] == AXIS_NONE;
    }
    if (given[0] != NULL && (value[0] == 'S' || value[0] == 'P')) {
        wish->action = value[0] == 'S' ? START : STOP;
        given[0] = NULL;
    }

    const bool both = given[1] != NULL && given[2] != NULL;
    if (given[0] == NULL && !two && (nine || (dialect == 0 && both))) {
        if (given[1] != NULL)
            wish->fast = value[1];
        if (given[2] != NULL)
            wish->slow = value[2];
        if ((wish->fast >= AXIS_COUNT && wish->fast != AXIS_NONE) ||
            (wish->slow >= AXIS_COUNT && wish->slow != AXIS_NONE) ||
            (wish->fast == wish->slow && wish->fast != AXIS_NONE))
            return STATUS_RANGE;
        return STATUS_OK;
    }

    for (int n = 0; n < 3; n++) {
        if (given[n] == NULL)
            continue;
        if (value[n] > 2 || (value[n] > 0 && (n >= AXIS_COUNT || named[value[n]] != AXIS_NONE)))
            return STATUS_RANGE;
        if (wish->fast == n)
            wish->fast = AXIS_NONE;
        if (wish->slow == n)
            wish->slow = AXIS_NONE;
        named[value[n]] = n;
    }
    if (named[1] != AXIS_NONE)
        wish->fast = named[1];
    if (named[2] != AXIS_NONE)
        wish->slow = named[2];
    return STATUS_OK;
}

static enum status interpret(const struct request *request, struct wish *wish)
{
    *wish = (struct wish){.action = request->count == 0 ? TOGGLE : NOTHING,
                          .fast = axis_set(request, 'R', fast_axis),
                          .slow = axis_set(request, 'T', slow_axis)};

    const enum status status = take_roles(request, wish);
    if (status != STATUS_OK)
        return status;
    for (size_t n = 0; n < request->count; n++) {
        const struct argument *argument = &request->arguments[n];

        if (argument->letter != 'S' && argument->letter != 'P')
            continue;
        if (argument->kind != ARGUMENT_BARE)
            return STATUS_RANGE;
        wish->action = argument->letter == 'S' ? START : STOP;
    }
    if (wish->action == TOGGLE)
        wish->action = scan_run_state() == SCAN_IDLE ? START : STOP;
    if (wish->action == START && scan_run_state() != SCAN_IDLE)
        wish->action = NOTHING;
    return STATUS_OK;
}

/* Before anything changes: a scan that could not start refuses the whole line. */
static enum status check_scan(const struct request *request)
{
    struct wish wish;
    const enum status status = interpret(request, &wish);

    if (status != STATUS_OK || wish.action != START)
        return status;

    const struct scan_setup setup = setup_of(&wish);
    return scan_run_check(&setup);
}

static int role(int axis)
{
    return axis == (int)fast_axis ? 1 : axis == (int)slow_axis ? 2 : 0;
}

static void print_query(struct reply *reply, char letter)
{
    switch (letter) {
    case 'X':
        reply_char(reply, (char)scan_run_state());
        break;
    case 'Y':
    case 'Z':
        reply_integer(reply, role(letter - 'X'));
        break;
    case 'F':
        reply_integer(reply, (int32_t)pattern);
        break;
    case 'R':
        reply_integer(reply, (int32_t)fast_axis);
        break;
    case 'T':
        reply_integer(reply, (int32_t)slow_axis);
        break;
    default:
        reply_integer(reply, (int32_t)dialect);
        break;
    }
}

/* Values without letters, those of parameter rows that were asked too in their places. */
static void print_queries(const struct request *request, struct reply *reply)
{
    reply_clear(reply);
    reply_open(reply, FORM_VALUES);
    for (const char *letter = "XYZFTRM"; *letter != '\0'; letter++) {
        const struct argument *argument = request_argument(request, *letter);

        if (argument == NULL || argument->kind != ARGUMENT_QUERY)
            continue;
        reply_field(reply, *letter);
        print_query(reply, *letter);
    }
    reply_close(reply);
}

static enum status run_scan(const struct request *request, struct reply *reply)
{
    struct wish wish;
    enum status status = interpret(request, &wish);

    if (status != STATUS_OK)
        return status;
    fast_axis = wish.fast;
    slow_axis = wish.slow;
    follow_fast_axis();
    if (wish.action == STOP)
        scan_run_stop();
    if (wish.action == START) {
        const struct scan_setup setup = setup_of(&wish);
        status = scan_run_start(&setup);
        if (status != STATUS_OK)
            return status;
    }
    print_queries(request, reply);
    return STATUS_OK;
}

bool scan_start(void)
{
    const struct wish wish = {.fast = (int)fast_axis, .slow = (int)slow_axis};
    const struct scan_setup setup = setup_of(&wish);

    return scan_run_start(&setup) == STATUS_OK;
}

void scan_trigger(void)
{
    (void)scan_start();
}

bool scan_stop(void)
{
    if (scan_run_state() == SCAN_IDLE)
        return false;
    scan_run_stop();
    return true;
}

/* A stop that is set takes the place of a number of pixels. */
static void set_stop(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    pixels = 0;
}

static double counts_per_mm(void)
{
    const int axis = axis_or_none(fast_axis);

    return coordinates_counts_per_mm(axis >= 0 ? (unsigned)axis : 0);
}

static double get_stop(unsigned axis)
{
    const struct scan_settings settings = line_settings();

    (void)axis;
    return scan_plan_stop_mm(&settings, counts_per_mm());
}

static double get_pixels(unsigned axis)
{
    const struct scan_settings settings = line_settings();

    (void)axis;
    return scan_plan_pixels(&settings, counts_per_mm());
}

static enum status check_width(unsigned axis, double value)
{
    (void)axis;
    return value == 0 || value >= 0.01 ? STATUS_OK : STATUS_RANGE;
}

static enum status check_axis(unsigned axis, double value)
{
    (void)axis;
    return value < AXIS_COUNT || value == AXIS_NONE ? STATUS_OK : STATUS_RANGE;
}

static void set_direct(unsigned axis, double value)
{
    (void)axis;
    pins_encoder_direct(value != 0);
}

static void set_axis(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    follow_fast_axis();
}

static const struct command commands[] = {
    {
        .name = "SCAN", .shortcut = "SN", .form = FORM_VALUES,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_QUERY, .letters = "XYZSP",
        .check = check_scan, .run = run_scan,
        .summary = "Starts and stops a scan; X=1 Y=2 Z=0 names the fast, the slow and no axis.",
    },
    {
        .name = "SCANR", .shortcut = "NR", .form = FORM_P, .summary = "The line of a scan.",
    },
    {
        .name = "SCANV", .shortcut = "NV", .form = FORM_P,
        .summary = "The lines of a scan, and what is around them.",
    },
    {0},
};

#define LENGTH_MAX_MM 1e5
#define COUNT_MAX 2147483647.0

static const struct parameter parameters[] = {
    {
        .command = "SCAN", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &pattern, .saved = SAVED_BY_SS,
        .summary = "0 raster, all lines from start to stop; 1 serpentine, every other one back.",
    },
    {
        .command = "SCAN", .letter = 'R', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = AXIS_NONE, .initial = 0, .value = &fast_axis,
        .check = check_axis, .set = set_axis, .saved = SAVED_BY_SS,
        .summary = "Number of the fast axis, 9 for none; what SCAN X= Y= Z= come to.",
    },
    {
        .command = "SCAN", .letter = 'T', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = AXIS_NONE, .initial = AXIS_COUNT > 1 ? 1 : AXIS_NONE,
        .value = &slow_axis, .check = check_axis, .saved = SAVED_BY_SS,
        .summary = "Number of the slow axis, 9 for none.",
    },
    {
        .command = "SCAN", .letter = 'M', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &dialect, .saved = SAVED_BY_SS,
        .summary = "SCAN Y= Z= without X: 0 axis numbers (Y fast, Z slow), 1 always roles.",
    },
    {
        .command = "SCANR", .letter = 'X', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = -LENGTH_MAX_MM, .maximum = LENGTH_MAX_MM, .initial = 0, .value = &start_mm,
        .saved = SAVED_BY_SS, .summary = "Start of the line.",
    },
    {
        .command = "SCANR", .letter = 'Y', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = -LENGTH_MAX_MM, .maximum = LENGTH_MAX_MM, .initial = 0, .value = &stop_mm,
        .set = set_stop, .get = get_stop, .saved = SAVED_BY_SS,
        .summary = "Stop of the line; takes the place of F.",
    },
    {
        .command = "SCANR", .letter = 'Z', .type = PARAMETER_REAL, .decimals_max = 6,
        .unit = "counts", .minimum = 1, .maximum = COUNT_MAX, .below = OUTSIDE_REFUSE,
        .above = OUTSIDE_REFUSE, .initial = 24, .value = &pitch_counts, .saved = SAVED_BY_SS,
        .summary = "Encoder counts per pixel; may have a fraction.",
    },
    {
        .command = "SCANR", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "pixels",
        .minimum = 0, .maximum = COUNT_MAX, .initial = 0, .value = &pixels, .get = get_pixels,
        .saved = SAVED_BY_SS,
        .summary = "Pixels of the line, from X toward Y; takes the place of Y. 0: as Y says.",
    },
    {
        .command = "SCANR", .letter = 'R', .type = PARAMETER_REAL, .decimals = 6, .unit = "%",
        .minimum = 0.01, .maximum = 100, .initial = 67, .value = &retrace_percent,
        .saved = SAVED_BY_SS, .summary = "Speed of the way back, of the axis' maximum.",
    },
    {
        .command = "SCANR", .letter = 'T', .type = PARAMETER_REAL, .decimals = 6, .unit = "us",
        .minimum = 0, .maximum = 80000, .initial = 0, .value = &width_us, .check = check_width,
        .taken = "0, 0.01 ... 80000",
        .saved = SAVED_BY_SS,
        .summary = "Length of a pixel pulse; 0: half a pixel at the line speed, at most 10 us.",
    },
    {
        .command = "SCANR", .letter = 'M', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &direct, .set = set_direct,
        .saved = SAVED_BY_SS,
        .summary = "ENCODER output: 0 pixel pulses (DIVIDE), 1 encoder channel A (DIRECT).",
    },
    {
        .command = "SCANV", .letter = 'X', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = -LENGTH_MAX_MM, .maximum = LENGTH_MAX_MM, .initial = 0,
        .value = &slow_start_mm, .saved = SAVED_BY_SS, .summary = "Place of the first line.",
    },
    {
        .command = "SCANV", .letter = 'Y', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = -LENGTH_MAX_MM, .maximum = LENGTH_MAX_MM, .initial = 0,
        .value = &slow_stop_mm, .saved = SAVED_BY_SS,
        .summary = "Where the line after the last one would be.",
    },
    {
        .command = "SCANV", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "lines",
        .minimum = 1, .maximum = COUNT_MAX, .initial = 1, .value = &lines, .saved = SAVED_BY_SS,
        .summary = "Number of lines.",
    },
    {
        .command = "SCANV", .letter = 'F', .type = PARAMETER_REAL, .decimals_max = 6, .unit = "ms",
        .minimum = 0, .maximum = 32767, .initial = 10, .value = &settle_ms, .saved = SAVED_BY_SS,
        .summary = "Time at constant speed before the line and after it.",
    },
    {
        .command = "SCANV", .letter = 'T', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = 0, .maximum = 1000, .initial = 0, .value = &overshoot_mm, .saved = SAVED_BY_SS,
        .summary = "Way at constant speed before the line and after it, besides F.",
    },
    {
        .command = "SCANV", .letter = 'R', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = AXIS_COUNT, .initial = 0, .value = &sync_axis,
        .saved = SAVED_BY_SS,
        .summary = "Jumper JP1, axis of SYNC: 0 the fast one, 1 X, 2 Y, 3 Z, 4 F.",
    },
    {
        .command = "SCANV", .letter = 'M', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = AXIS_COUNT, .initial = 0, .value = &encoder_axis, .set = set_axis,
        .saved = SAVED_BY_SS,
        .summary = "Jumper JP2, axis of ENCODER: as R.",
    },
    {0},
};

static const char *const build_lines[] = {"SCAN MODULE", NULL};

const struct module scan_module = {
    .name = "scan", .commands = commands, .parameters = parameters,
    .build_lines = build_lines,
    .init = scan_run_init, .poll = scan_run_poll,
};
