/* SPDX-License-Identifier: BSD-2-Clause */
#include "sample.h"

#include <stddef.h>

#include "core/events.h"
#include "core/fault.h"

double sample_level_percent[AXIS_COUNT];
bool sample_lit;
unsigned sample_sets, sample_ticks, sample_faults, sample_urgent, sample_inits;
uint32_t sample_last_argument;
uint64_t sample_last_time;

static double fade_ms, colour, flashes, step_mm, offset[AXIS_COUNT], gain[AXIS_COUNT], fence_mm[AXIS_COUNT];

/* --- parameters: most need nothing but their row ------------------------------------------------ */

static void level_set(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    sample_sets++;
}

/* Only primary colours are there: 1, 2 and 4. */
static enum status colour_check(unsigned axis, double value)
{
    (void)axis;
    return value == 1 || value == 2 || value == 4 ? STATUS_OK : STATUS_RANGE;
}

/* Kept in whole encoder counts, 2 to the millimetre. */
static double step_adjust(unsigned axis, double value)
{
    (void)axis;
    return (double)(int32_t)(value * 2) / 2;
}

static double uptime_get(unsigned axis)
{
    (void)axis;
    return 12.5;
}

/* X+ puts the fence here (7 mm), X- gives the default back; Y has no "here". */
static enum status fence_sign(unsigned axis, bool plus, bool act)
{
    if (plus && axis == 1)
        return STATUS_FAILED;
    if (act)
        fence_mm[axis] = plus ? 7 : 100;
    return STATUS_OK;
}

/* --- commands that are more than parameters ------------------------------------------------------- */

static enum status lamp(const struct request *request, struct reply *reply)
{
    if (request->count == 0) {
        reply_text(reply, sample_lit ? "B" : "N");
        return STATUS_OK;
    }
    const struct argument *start = request_argument(request, 'S');

    sample_lit = start != NULL;
    events_publish(EVENT_BUSY, sample_lit, events_now());
    return STATUS_OK;
}

static enum status lamp_check(const struct request *request)
{
    return request_argument(request, 'S') != NULL && request_argument(request, 'P') != NULL
               ? STATUS_RANGE
               : STATUS_OK;
}

static enum status where(const struct request *request, struct reply *reply)
{
    reply_open(reply, FORM_V);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (request->count > 0 && request_argument(request, axis_letter(axis)) == NULL)
            continue;
        reply_field(reply, axis_letter(axis));
        reply_number(reply, 100.25 * axis, (unsigned)reply_position_decimals);
    }
    reply_close(reply);
    return STATUS_OK;
}

/* A text longer than any buffer: 40 lines, one each time we are called. */
static enum status story(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, "line");
    reply_integer(reply, (int32_t)reply->step);
    reply_pad_to(reply, 33);
    reply_text_right(reply, "value", 10);
    reply_number_right(reply, 1.5, 2, 8);
    if (++reply->step == 40)
        return STATUS_OK;
    reply_end_line(reply);
    return STATUS_PENDING;
}

static enum status halt(const struct request *request, struct reply *reply)
{
    (void)request;
    (void)reply;
    bool was_lit = sample_urgent > 0 && sample_lit;

    sample_lit = false;
    return was_lit ? STATUS_HALTED : STATUS_OK;
}

static bool halt_now(void)
{
    sample_urgent++;
    return false;
}

static enum status fail(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, "this text is dropped");
    log_error(FAULT_ENCODER);
    return STATUS_FAILED;
}

static enum status silent(const struct request *request, struct reply *reply)
{
    (void)request;
    (void)reply;
    return STATUS_SILENT;
}

static enum status flood(const struct request *request, struct reply *reply)
{
    (void)request;
    for (int i = 0; i < 1000; i++)
        reply_char(reply, 'x');
    return STATUS_OK;
}

bool sample_take_button(void)
{
    bool was_lit = sample_lit;

    sample_lit = false;
    return was_lit;
}

/* --- events ----------------------------------------------------------------------------------------- */

static void on_tick(const struct event *event)
{
    sample_ticks++;
    sample_last_argument = event->argument;
    sample_last_time = event->time_fast;
}

static void on_fault(const struct event *event)
{
    sample_faults++;
    sample_last_argument = event->argument;
}

static void init(void)
{
    sample_inits++;
    sample_lit = false;
    sample_sets = sample_ticks = sample_faults = sample_urgent = 0;
}

/* --- the tables ------------------------------------------------------------------------------------ */

static const struct command commands[] = {
    {.name = "LEVEL", .shortcut = "L", .form = FORM_P, .summary = "Brightness."},
    {.name = "GAIN", .shortcut = "G", .form = FORM_S, .summary = "Gain."},
    {.name = "TINT", .form = FORM_L, .summary = "Colour, fade, step."},
    {.name = "FENCE", .form = FORM_VALUES, .summary = "Fence and offset."},
    {.name = "OFFSET", .form = FORM_V, .summary = "Offset."},
    {.name = "LAMP", .shortcut = "LA", .run = lamp, .check = lamp_check, .letters = "SP",
     .accepts = ARGUMENT_BARE, .summary = "Switch the lamp; bare: is it lit."},
    {.name = "WHERE", .shortcut = "W", .run = where, .accepts = ARGUMENT_BARE, .summary = "Where."},
    {.name = "STORY", .run = story, .summary = "A long text."},
    {.name = "HALT", .shortcut = "\\", .run = halt, .urgent = halt_now, .summary = "Off."},
    {.name = "STATUS", .shortcut = "/", .run = lamp, .summary = "Is it lit."},
    {.name = "FAIL", .run = fail, .flags = COMMAND_NEEDS_ARGUMENT, .accepts = ARGUMENT_VALUE,
     .summary = "Never works."},
    {.name = "SILENT", .run = silent, .letters = LETTERS_ALL, .accepts = ARGUMENT_BARE,
     .summary = "Says nothing."},
    {.name = "FLOOD", .run = flood, .summary = "Writes too much."},
    {0},
};

static const struct parameter parameters[] = {
    {.command = "LEVEL", .letter = PARAMETER_AXES, .decimals = 6, .unit = "%", .minimum = 1,
     .maximum = 100, .above = OUTSIDE_CLIP, .initial = 5, .value = sample_level_percent,
     .set = level_set, .summary = "Brightness of the lamp of an axis."},
    {.command = "LEVEL", .letter = 'T', .unit = "s", .decimals = 1, .get = uptime_get,
     .read_only = true, .saved = SAVED_NEVER, .summary = "Time since it was lit."},
    {.command = "GAIN", .letter = PARAMETER_AXES, .type = PARAMETER_INTEGER, .minimum = -100,
     .maximum = 100, .below = OUTSIDE_IGNORE, .value = gain, .initial = 50, .summary = "Gain."},
    {.command = "TINT", .letter = 'X', .type = PARAMETER_INTEGER, .minimum = 0, .maximum = 7,
     .value = &colour, .initial = 1, .check = colour_check, .summary = "Colour."},
    {.command = "TINT", .letter = 'Z', .decimals = 0, .decimals_max = 6, .minimum = 0,
     .maximum = 1e6, .value = &fade_ms, .initial = 24, .unit = "ms", .summary = "Fade."},
    {.command = "TINT", .letter = 'R', .decimals = 3, .minimum = 0, .maximum = 1000,
     .value = &step_mm, .adjust = step_adjust, .saved = SAVED_AT_ONCE, .unit = "mm",
     .summary = "Step."},
    {.command = "LAMP", .letter = 'F', .type = PARAMETER_INTEGER, .minimum = 0, .maximum = 9,
     .value = &flashes, .summary = "Flashes."},
    {.command = "FENCE", .letter = PARAMETER_AXES, .decimals = 0, .minimum = -1e3, .maximum = 1e3,
     .value = fence_mm, .initial = 100, .sign = fence_sign, .unit = "mm", .summary = "Fence."},
    {.command = "OFFSET", .letter = PARAMETER_AXES, .decimals = 1, .minimum = -1e9, .maximum = 1e9,
     .value = offset, .saved = SAVED_NEVER, .summary = "Offset."},
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_SERVO_TURN, EVENT_IN_INTERRUPT, on_tick},
    {EVENT_FAULT, EVENT_IN_MAIN, on_fault},
    {0},
};

static const char *const build_lines[] = {"SAMPLE MODULE", NULL};

const struct module sample_module = {
    .name = "sample",
    .commands = commands,
    .parameters = parameters,
    .subscriptions = subscriptions,
    .build_lines = build_lines,
    .init = init,
};

const struct module *const sample_modules[] = {&sample_module, NULL};
