/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/ttl.h"

#include <stddef.h>

#include "modules/motion.h"
#include "modules/move.h"
#include "modules/pins.h"
#include "modules/positions.h"
#include "modules/ring_buffer.h"
#include "modules/scan.h"
#include "modules/z_stack.h"

/* What a rising edge at IN0 does. The numbers between belong to modules that are not built. */
enum in0_mode {
    IN0_OFF = 0,
    IN0_RING_NEXT = 1, /* and the pixels of a scan give pulses */
    IN0_REPEAT = 2,
    IN0_Z_STACK = 4,
    IN0_REPORT = 5,
    IN0_SCAN = 6, /* and its pixels give pulses */
    IN0_TOGGLE = 10,
    IN0_RING_RELATIVE = 12,
};

enum out0_mode {
    OUT0_LOW = 0,
    OUT0_HIGH = 1,
    OUT0_MOVE_END = 2,
    OUT0_CONSTANT = 3, /* and one more for each further axis: at constant speed */
    OUT0_MAX = OUT0_CONSTANT + AXIS_COUNT - 1,
};

#define FAST_PER_MS 200000.0

static const struct motion_owner repeat_owner = {.name = "repeat", .busy = true, .letter = 'B'};

static double in0_mode, out0_mode, polarity;
static double report_ms, pulse_ms;
static bool pulsing, reporting, halted;
static uint64_t pulse_end_fast, report_due_fast;

static uint64_t after_ms(double time_ms)
{
    return events_now() + (uint64_t)(time_ms * FAST_PER_MS);
}

/* --- OUT0 -------------------------------------------------------------------------------------- */

static bool at_constant_speed(unsigned axis)
{
    struct axis_view view;

    axis_read(axis, &view);
    return view.planned && view.commanded && !view.ramping && view.setpoint.velocity_q48 != 0;
}

static void end_pulse(void)
{
    if (pulsing)
        pins_out0(false);
    pulsing = false;
}

/* A pulse ends when a move begins. A HALT is no arrival. */
static void busy_changed(const struct event *event)
{
    if (out0_mode != OUT0_MOVE_END)
        return;
    end_pulse();
    if (event->argument == 0 && !halted && pulse_ms > 0) {
        pins_out0(true);
        pulsing = true;
        pulse_end_fast = after_ms(pulse_ms);
    }
    halted = false;
}

static void all_halted(const struct event *event)
{
    halted |= event->argument != 0;
    reporting = false;
}

static void set_out0_mode(unsigned axis, double mode)
{
    (void)axis;
    pulsing = false;
    pins_out0(mode == OUT0_HIGH);
}

/* --- IN0 --------------------------------------------------------------------------------------- */

static void repeat(void)
{
    int32_t targets[AXIS_COUNT];
    unsigned axes = 0;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const int32_t by_counts = move_relative_counts(axis);

        targets[axis] = motion_target_counts(axis) + by_counts;
        if (by_counts != 0)
            axes |= MOTION_AXIS(axis);
    }
    (void)move_to(&repeat_owner, axes, targets);
}

bool ttl_trigger(void)
{
    switch ((enum in0_mode)in0_mode) {
    case IN0_RING_NEXT:
        (void)ring_buffer_next(false);
        break;
    case IN0_RING_RELATIVE:
        (void)ring_buffer_next(true);
        break;
    case IN0_REPEAT:
        repeat();
        break;
    case IN0_Z_STACK:
        z_stack_step();
        break;
    case IN0_REPORT:
        reporting = true;
        report_due_fast = events_now();
        break;
    case IN0_SCAN:
        (void)scan_start();
        break;
    case IN0_TOGGLE:
        pins_out0(pins_out0_level() != (polarity > 0));
        break;
    default:
        break;
    }
    return true;
}

static void triggered(const struct event *event)
{
    if (event->argument != 0)
        (void)ttl_trigger();
}

static enum status check_in0_mode(unsigned axis, double mode)
{
    (void)axis;
    switch ((int)mode) {
    case IN0_OFF:
    case IN0_RING_NEXT:
    case IN0_REPEAT:
    case IN0_Z_STACK:
    case IN0_REPORT:
    case IN0_SCAN:
    case IN0_TOGGLE:
    case IN0_RING_RELATIVE:
        return STATUS_OK;
    default:
        return STATUS_RANGE;
    }
}

static void set_in0_mode(unsigned axis, double mode)
{
    (void)axis;
    reporting = false;
    pins_enable_pixels(mode == IN0_RING_NEXT || mode == IN0_SCAN);
}

/* --- Both -------------------------------------------------------------------------------------- */

static void poll(void)
{
    if (pulsing && events_now() >= pulse_end_fast)
        end_pulse();
    if (out0_mode >= OUT0_CONSTANT)
        pins_out0(at_constant_speed((unsigned)out0_mode - OUT0_CONSTANT));
    if (reporting && events_now() >= report_due_fast) {
        report_due_fast += (uint64_t)(report_ms * FAST_PER_MS);
        positions_report(ring_buffer_axes());
    }
}

static void init(void)
{
    pulsing = false;
    reporting = false;
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
        .name = "TTL", .form = FORM_P, .run = ttl,
        .summary = "Modes of the TTL connectors; without arguments the level of OUT0.",
    },
    {
        .name = "RTIME", .shortcut = "RT", .form = FORM_P, .summary = "Times of reports and pulses.",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "TTL", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 255, .initial = 0, .value = &in0_mode, .check = check_in0_mode,
        .set = set_in0_mode, .saved = SAVED_BY_SS,
        .summary = "A rising edge at IN0: 0 nothing; 1 next point of the ring buffer, and the "
                   "pixels of a scan give pulses; 2 repeats the last MOVREL; 4 a step of the "
                   "Z-stack; 5 starts timed reports of positions; 6 starts a scan, and its pixels "
                   "give pulses; 10 toggles OUT0; 12 next point of the ring buffer as a distance.",
    },
    {
        .command = "TTL", .letter = 'Y', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = OUT0_MAX, .initial = 1, .value = &out0_mode,
        .set = set_out0_mode, .saved = SAVED_BY_SS,
        .summary = "OUT0: 0 low; 1 high; 2 a pulse at the end of a commanded move; 3 and on: high "
                   "while the first (second ...) axis moves at constant speed.",
    },
    {
        .command = "TTL", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = -1, .maximum = 1, .initial = 1, .value = &polarity, .check = check_polarity,
        .set = set_polarity, .saved = SAVED_BY_SS,
        .summary = "Polarity of OUT0 and of the pixel pulses: 1 as is, -1 inverted.",
    },
    {
        .command = "RTIME", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "ms",
        .minimum = 20, .maximum = 32700, .initial = 200, .value = &report_ms,
        .saved = SAVED_BY_SS, .summary = "Time between timed reports (TTL X=5).",
    },
    {
        .command = "RTIME", .letter = 'Y', .type = PARAMETER_REAL, .decimals_max = 6, .unit = "ms",
        .minimum = 0, .maximum = 32767, .initial = 10, .value = &pulse_ms,
        .saved = SAVED_BY_SS, .summary = "Length of the pulse at the end of a move (TTL Y=2).",
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_BUSY, EVENT_IN_MAIN, busy_changed},
    {EVENT_HALT, EVENT_IN_MAIN, all_halted},
    {EVENT_TRIGGER_IN, EVENT_IN_MAIN, triggered},
    {0},
};

const struct module ttl_module = {
    .name = "ttl", .commands = commands, .parameters = parameters,
    .subscriptions = subscriptions, .init = init, .poll = poll,
};
