/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/dump.h"

#include <stddef.h>

#include "core/fault.h"
#include "modules/axis.h"

enum {
    CODES_PER_LINE = 16,
    SAMPLES_AT_ONCE = 4, /* what fits REPLY_MAX */
};

#define MARK_FAST (600 * EVENTS_FAST_PER_S)

struct sample {
    uint32_t turn;
    int32_t target_counts, position_counts;
    int16_t duty_steps;
    uint8_t axis;
};

/*
 * The recorder. The tick interrupt writes while `recording`; the main loop reads and clears only
 * while it is not.
 */
static struct sample samples[DUMP_STEPS];
static unsigned next, used;
static volatile bool recording;
static volatile bool overwrites;
static volatile uint32_t turns_per_sample;
static uint32_t turns;

/* Of the main loop. */
static double overwrite, interval;
static uint64_t mark_due_fast;

/* --- The recorder, in the tick interrupt ------------------------------------------------------- */

static void record(const struct event *event)
{
    if (!recording || turns++ % turns_per_sample != 0)
        return;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (used == DUMP_STEPS && !overwrites)
            return;
        struct axis_sample now;

        if (!axis_sample(axis, &now))
            continue;
        samples[next] = (struct sample){
            .turn = turns - 1,
            .target_counts = now.target_counts,
            .position_counts = now.position_counts,
            .duty_steps = (int16_t)now.duty_steps,
            .axis = (uint8_t)axis,
        };
        next = next + 1 < DUMP_STEPS ? next + 1 : 0;
        used += used < DUMP_STEPS;
    }
    (void)event;
}

/* --- The main loop ----------------------------------------------------------------------------- */

static void clear(void)
{
    recording = false;
    used = 0;
    next = 0;
    recording = true;
}

static void print_sample(struct reply *reply, unsigned n)
{
    const unsigned first = used < DUMP_STEPS ? 0 : next;
    const struct sample *sample = &samples[(first + n) % DUMP_STEPS];
    const int32_t values[] = {
        (int32_t)(sample->turn - samples[first].turn), sample->axis,
        sample->target_counts, sample->position_counts,
        sample->target_counts - sample->position_counts, sample->duty_steps,
    };

    for (unsigned i = 0; i < sizeof values / sizeof *values; i++) {
        if (i > 0)
            reply_char(reply, ' ');
        reply_integer(reply, values[i]);
    }
}

/* Some lines a call; nothing is recorded until the last has been written. */
static enum status print_trajectory(struct reply *reply)
{
    if (reply->step == 0)
        recording = false;
    for (unsigned n = 0; n < SAMPLES_AT_ONCE && reply->step < used; n++) {
        print_sample(reply, reply->step);
        reply->step++;
        if (reply->step < used)
            reply_end_line(reply);
    }
    if (reply->step < used)
        return STATUS_PENDING;
    recording = true;
    return STATUS_OK;
}

static void print_errors(struct reply *reply)
{
    for (unsigned entry = 0; entry < FAULT_LOG; entry++) {
        reply_integer(reply, fault_read(entry));
        if (entry == FAULT_LOG - 1)
            break;
        if (entry % CODES_PER_LINE == CODES_PER_LINE - 1)
            reply_end_line(reply);
        else
            reply_char(reply, ' ');
    }
}

static enum status dump(const struct request *request, struct reply *reply)
{
    if (request_argument(request, 'X') != NULL) {
        clear();
        fault_clear();
    }
    if (request_argument(request, 'Y') != NULL) {
        print_errors(reply);
        return STATUS_OK;
    }
    return request->count == 0 ? print_trajectory(reply) : STATUS_OK;
}

static void set_overwrite(unsigned axis, double value)
{
    (void)axis;
    overwrites = value != 0;
}

static void set_interval(unsigned axis, double value)
{
    (void)axis;
    turns_per_sample = (uint32_t)value;
}

/* A mark every ten minutes shows how old the entries before it are; two marks in a row say no more. */
static void poll(void)
{
    if (events_now() < mark_due_fast)
        return;
    mark_due_fast += MARK_FAST;
    if (fault_read(0) != FAULT_NONE && fault_read(0) != FAULT_TEN_MINUTES)
        log_error(FAULT_TEN_MINUTES);
}

static void init(void)
{
    mark_due_fast = events_now() + MARK_FAST;
    clear();
}

static const struct command commands[] = {
    {
        .name = "DUMP", .shortcut = "DU", .form = FORM_P, .run = dump,
        .accepts = ARGUMENT_BARE, .letters = "XY",
        .summary = "The last motions, a line for each turn of the servo and axis: turn, axis number, set-point, "
                   "position, error (counts), drive (steps). X clears them and the error log, "
                   "Y prints the error log, newest first.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "DUMP", .letter = 'R', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &overwrite, .set = set_overwrite,
        .saved = SAVED_NEVER,
        .summary = "A full record: 0 ends until DU X, 1 goes on over the oldest lines.",
    },
    {
        .command = "DUMP", .letter = 'T', .type = PARAMETER_INTEGER, .unit = "turns",
        .minimum = 1, .maximum = 32767, .initial = 1, .value = &interval, .set = set_interval,
        .saved = SAVED_NEVER, .summary = "Turns of the servo, 0.5 ms, from one recorded to the next.",
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_SERVO_TURN, EVENT_IN_INTERRUPT, record},
    {0},
};

const struct module dump_module = {
    .name = "dump", .commands = commands, .parameters = parameters,
    .subscriptions = subscriptions, .init = init, .poll = poll,
};
