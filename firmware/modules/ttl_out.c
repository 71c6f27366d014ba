/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/ttl_out.h"

#include <stddef.h>

#include "modules/led_dimmer.h"
#include "modules/motion.h"
#include "modules/pins.h"
#include "modules/ttl_modes.h"

static double out0_mode, polarity, pulse_ms;
static const struct ttl_out_mode *present = &ttl_out_modes[0];
static bool pulsing, halted;
static uint64_t pulse_end_fast;

/* --- Modes ------------------------------------------------------------------------------------- */

static const struct ttl_out_mode *find(int number)
{
    const struct ttl_out_mode *mode = ttl_out_modes;

    for (; mode->number >= 0; mode++)
        if (mode->number == number)
            return mode;
    return NULL;
}

static enum status check_out0_mode(unsigned axis, double mode)
{
    (void)axis;
    return find((int)mode) != NULL ? STATUS_OK : STATUS_RANGE;
}

static void set_out0_mode(unsigned axis, double mode)
{
    (void)axis;
    if (present->end != NULL)
        present->end();
    present = find((int)mode);
    if (present->begin != NULL)
        present->begin();
}

void ttl_out_low(void)
{
    pins_out0(false);
}

void ttl_out_high(void)
{
    pins_out0(true);
}

void ttl_out_toggle(void)
{
    pins_out0(pins_out0_level() != (polarity > 0));
}

bool ttl_out_at_constant_speed(unsigned axis)
{
    struct axis_view view;

    axis_read(axis, &view);
    return view.planned && view.commanded && !view.ramping && view.setpoint.velocity_q48 != 0;
}

/* --- A pulse at the end of a move -------------------------------------------------------------- */

void ttl_out_end_pulse(void)
{
    if (pulsing)
        pins_out0(false);
    pulsing = false;
}

/* A pulse ends when a move begins. A HALT is no arrival; nor is the last point, once more, when all is
 * over. */
static void move_begins_or_ends(const struct event *event)
{
    if (present->end != ttl_out_end_pulse || (event->argument == 0 && pulsing))
        return;
    ttl_out_end_pulse();
    if (event->argument == 0 && !halted && pulse_ms > 0) {
        pins_out0(true);
        pulsing = true;
        pulse_end_fast = events_now() + (uint64_t)(pulse_ms * EVENTS_FAST_PER_MS);
    }
    halted = false;
}

static void all_halted(const struct event *event)
{
    halted |= event->argument != 0;
}

/* --- Both -------------------------------------------------------------------------------------- */

static void poll(void)
{
    if (pulsing && events_now() >= pulse_end_fast)
        ttl_out_end_pulse();
    if (present->level != NULL)
        pins_out0(present->level(present->argument));
}

static void init(void)
{
    pulsing = false;
    halted = false;
}

static enum status ttl(const struct request *request, struct reply *reply)
{
    (void)request;
    reply_text(reply, pins_out0_level() ? ":A 1" : ":A 0");
    return STATUS_OK;
}

static enum status check_polarity(unsigned axis, double value)
{
    (void)axis;
    return value == 1 || value == -1 ? STATUS_OK : STATUS_RANGE;
}

static void set_polarity(unsigned axis, double value)
{
    (void)axis;
    pins_invert(value < 0);
}

static const struct command commands[] = {
    {
        .name = "TTL", .form = FORM_P, .run = ttl, .check = led_dimmer_check,
        .summary = "Modes of the TTL connectors; without arguments the level of OUT0.",
    },
    {
        .name = "RTIME", .shortcut = "RT", .form = FORM_P, .summary = "Times of reports and pulses.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "TTL", .letter = 'Y', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 255, .initial = 1, .value = &out0_mode, .check = check_out0_mode,
        .set = set_out0_mode, .saved = SAVED_BY_SS,
        .summary = "OUT0: 0 low; 1 high; 2 a pulse at the end of a commanded move; 3 and on: high "
                   "while the first (second ...) axis moves at constant speed; 9 modulation of a "
                   "lamp (LED), and a number behind is LED X.",
    },
    {
        .command = "TTL", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = -1, .maximum = 1, .initial = 1, .value = &polarity, .check = check_polarity,
        .set = set_polarity, .saved = SAVED_BY_SS,
        .summary = "Polarity of OUT0 and of the pixel pulses: 1 as is, -1 inverted.",
    },
    {
        .command = "RTIME", .letter = 'Y', .type = PARAMETER_REAL, .decimals_max = 6, .unit = "ms",
        .minimum = 0, .maximum = 32767, .initial = 10, .value = &pulse_ms,
        .saved = SAVED_BY_SS, .summary = "Length of the pulse at the end of a move (TTL Y=2).",
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_BUSY, EVENT_IN_MAIN, move_begins_or_ends},
    {EVENT_POINT, EVENT_IN_MAIN, move_begins_or_ends},
    {EVENT_HALT, EVENT_IN_MAIN, all_halted},
    {0},
};

const struct module ttl_out_module = {
    .name = "ttl out", .commands = commands, .parameters = parameters,
    .subscriptions = subscriptions, .init = init, .poll = poll,
};
