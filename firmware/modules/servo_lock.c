/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/servo_lock.h"

#include <math.h>
#include <stddef.h>

#include "core/action.h"
#include "modules/coordinates.h"
#include "modules/motion.h"
#include "modules/move.h"
#include "modules/ring_buffer.h"
#include "modules/servo_lock_run.h"

/* What LK F takes: T engages, Z disengages. */
enum { CODE_ENGAGE = 'T', CODE_DISENGAGE = 'Z' };

/* What LK X? answers, in CRISP's letters. */
enum { LETTER_ENGAGED = 'T', LETTER_IDLE = 'I' };

#define FAST_NS 5.0

static double threshold_ms, range_mm, at_threshold, filter_ns;

static struct classifier_settings settings(void)
{
    return (struct classifier_settings){
        .threshold_fast = (uint32_t)llround(threshold_ms * EVENTS_FAST_PER_MS),
        .filter_fast = (uint32_t)llround(filter_ns / FAST_NS),
        .at_threshold = at_threshold != 0,
    };
}

static bool engage(void)
{
    const struct classifier_settings pulse = settings();

    return servo_lock_engage(&pulse, range_mm);
}

bool servo_lock_toggle(void)
{
    if (!servo_lock_engaged())
        return engage();
    servo_lock_leave();
    return true;
}

/* --- LOCK -------------------------------------------------------------------------------------- */

static enum status check_lock(const struct request *request)
{
    for (size_t i = 0; i < request->count; i++) {
        const struct argument *argument = &request->arguments[i];

        if (argument->letter != 'X' && argument->letter != 'F')
            continue;
        /* What these answer stands alone. */
        if (request->count > 1)
            return STATUS_RANGE;
        if (argument->letter == 'X' ? argument->kind != ARGUMENT_QUERY
                                    : argument->kind != ARGUMENT_VALUE ||
                                          (argument->value != CODE_ENGAGE &&
                                           argument->value != CODE_DISENGAGE))
            return STATUS_RANGE;
    }
    return STATUS_OK;
}

static enum status lock(const struct request *request, struct reply *reply)
{
    const struct argument *code = request_argument(request, 'F');

    if (request_argument(request, 'X') != NULL) {
        reply_text(reply, ":A ");
        reply_char(reply, servo_lock_engaged() ? LETTER_ENGAGED : LETTER_IDLE);
        return STATUS_OK;
    }
    if (code == NULL)
        return action_perform(ACTION_LOCK) ? STATUS_OK : STATUS_FAILED;
    if (code->value == CODE_ENGAGE)
        return engage() ? STATUS_OK : STATUS_FAILED;
    servo_lock_leave();
    return STATUS_OK;
}

static unsigned first_axis(void)
{
    unsigned axis = 0;

    while (axis < AXIS_COUNT - 1 && (ring_buffer_axes() & MOTION_AXIS(axis)) == 0)
        axis++;
    return axis;
}

static enum status check_step(unsigned axis, double user)
{
    (void)axis;
    for (unsigned n = 0; n < AXIS_COUNT; n++)
        if ((ring_buffer_axes() & MOTION_AXIS(n)) != 0 && !coordinates_fits(n, user))
            return STATUS_RANGE;
    return STATUS_OK;
}

static void set_step(unsigned axis, double user)
{
    (void)axis;
    for (unsigned n = 0; n < AXIS_COUNT; n++)
        if ((ring_buffer_axes() & MOTION_AXIS(n)) != 0)
            move_set_relative(n, user);
    servo_lock_steps_changed();
}

static double get_step(unsigned axis)
{
    (void)axis;
    return coordinates_part_counts_to_distance(first_axis(),
                                               move_relative_part_counts(first_axis()));
}

static double get_pulses(unsigned axis)
{
    (void)axis;
    return servo_lock_counts().pulses;
}

static double get_clipped(unsigned axis)
{
    (void)axis;
    return servo_lock_counts().clipped;
}

static double get_lost(unsigned axis)
{
    (void)axis;
    return servo_lock_counts().lost;
}

/* --- Settings ---------------------------------------------------------------------------------- */

static void configure(unsigned axis, double value)
{
    const struct classifier_settings pulse = settings();

    (void)axis;
    (void)value;
    servo_lock_configure(&pulse);
}

static double adjust_threshold(unsigned axis, double ms)
{
    (void)axis;
    return fmax(1, round(ms * EVENTS_FAST_PER_MS)) / EVENTS_FAST_PER_MS;
}

static double adjust_filter(unsigned axis, double ns)
{
    (void)axis;
    return round(ns / FAST_NS) * FAST_NS;
}

static const struct parameter parameters[] = {
    {
        .command = "RTIME", .letter = 'R', .type = PARAMETER_REAL, .decimals_max = 6, .unit = "ms",
        .minimum = 0.000005, .maximum = 10000, .initial = 0.75, .value = &threshold_ms,
        .adjust = adjust_threshold, .set = configure, .saved = SAVED_BY_SS,
        .summary = "Servo lock: pulses as long as this or longer are long, others short; to the "
                   "nearest 5 ns.",
    },
    {
        .command = "LOCKRG", .letter = 'Z', .type = PARAMETER_REAL, .decimals_max = 6, .unit = "mm",
        .minimum = 0, .maximum = 1000, .initial = 1, .value = &range_mm, .saved = SAVED_BY_SS,
        .summary = "Servo lock: the furthest that pulses move an axis from where it was engaged, "
                   "either way; taken when it is engaged.",
    },
    {
        .command = "LOCK", .letter = 'R', .type = PARAMETER_REAL, .decimals_max = 6,
        .unit = "user units", .minimum = -1e9, .maximum = 1e9, .check = check_step,
        .taken = "-1e6 ... 1e6, within the range of the counts",
        .set = set_step, .get = get_step, .saved = SAVED_NEVER,
        .summary = "Servo lock: the step of all axes that respond, without a move; MOVREL sets it "
                   "axis by axis.",
    },
    {
        .command = "LOCK", .letter = 'S', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &at_threshold, .set = configure,
        .saved = SAVED_BY_SS,
        .summary = "Servo lock: 0 a short pulse acts as it ends; 1 at the threshold, by the level "
                   "then, as the original does.",
    },
    {
        .command = "LOCK", .letter = 'G', .type = PARAMETER_INTEGER, .unit = "ns",
        .minimum = 0, .maximum = CLASSIFIER_FILTER_MAX_FAST * FAST_NS, .initial = 95,
        .value = &filter_ns, .adjust = adjust_filter, .set = configure, .saved = SAVED_BY_SS,
        .summary = "Servo lock: pulses and pauses as short as this or shorter are noise; to the "
                   "nearest 5 ns.",
    },
    {
        .command = "LOCK", .letter = 'N', .type = PARAMETER_INTEGER, .unit = "pulses",
        .minimum = 0, .maximum = 4294967295.0, .read_only = true, .get = get_pulses,
        .saved = SAVED_NEVER, .summary = "Servo lock: pulses since it was engaged.",
    },
    {
        .command = "LOCK", .letter = 'C', .type = PARAMETER_INTEGER, .unit = "pulses",
        .minimum = 0, .maximum = 4294967295.0, .read_only = true, .get = get_clipped,
        .saved = SAVED_NEVER,
        .summary = "Servo lock: those of them that LOCKRG Z cut short, on one axis or more.",
    },
    {
        .command = "LOCK", .letter = 'L', .type = PARAMETER_INTEGER, .unit = "pulses",
        .minimum = 0, .maximum = CLASSIFIER_LOST_MAX, .read_only = true, .get = get_lost,
        .saved = SAVED_NEVER,
        .summary = "Servo lock: pulses since it was engaged that came faster than they could be "
                   "taken, and are lost.",
    },
    {0},
};

static const struct command commands[] = {
    {
        .name = "LOCK", .shortcut = "LK", .form = FORM_P, .run = lock, .check = check_lock,
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE | ARGUMENT_QUERY, .letters = "XF",
        .summary = "Pulses at IN0 move the stage by steps: without arguments on or off; F=84 on, "
                   "F=90 off; X? answers T while it is on, else I.",
    },
    {.name = "LOCKRG", .shortcut = "LR", .form = FORM_P, .summary = "Range of a lock."},
    {0},
};

static const char *const build_lines[] = {"SERVOLOCK_TTL", NULL};

const struct module servo_lock_module = {
    .name = "servo lock", .commands = commands, .parameters = parameters,
    .build_lines = build_lines, .init = servo_lock_init, .poll = servo_lock_poll,
};
