/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/ttl_in.h"

#include <stddef.h>

#include "modules/motion.h"
#include "modules/move.h"
#include "modules/pins.h"
#include "modules/positions.h"
#include "modules/ring_buffer.h"
#include "modules/ttl_modes.h"

enum { NOT_FORCED = -1 };

static const struct motion_owner repeat_owner = {.name = "repeat", .busy = true, .letter = 'B'};

static double in0_mode, profile, report_ms;
static int forced = NOT_FORCED;
static const struct ttl_in_mode *present = &ttl_in_modes[0];
static volatile bool stale = true; /* what was planned ahead may not be what a trigger would do now */
static uint32_t seen_generation;
static bool reporting;
static uint64_t report_due_fast;

/* --- Modes ------------------------------------------------------------------------------------- */

static const struct ttl_in_mode *find(int number)
{
    const unsigned in_profile = 1u << (unsigned)profile;
    const struct ttl_in_mode *mode = ttl_in_modes;

    for (; mode->profiles != 0; mode++)
        if ((mode->profiles & in_profile) != 0 &&
            (mode->number == number || (mode->number == TTL_IN_ANY && number != 0)))
            return mode;
    return NULL;
}

static void change(const struct ttl_in_mode *to)
{
    motion_unprepare();
    stale = true;
    if (present->end != NULL)
        present->end();
    present = to;
    pins_enable_pixels(present->pixels);
    if (present->begin != NULL)
        present->begin();
}

static enum status check_in0_mode(unsigned axis, double mode)
{
    const struct ttl_in_mode *wanted = find((int)mode);

    (void)axis;
    if (present->taken)
        return STATUS_FAILED;
    return wanted != NULL && !wanted->taken ? STATUS_OK : STATUS_RANGE;
}

static void set_in0_mode(unsigned axis, double mode)
{
    (void)axis;
    if (forced == NOT_FORCED)
        change(find((int)mode));
}

static double get_in0_mode(unsigned axis)
{
    (void)axis;
    return forced != NOT_FORCED ? forced : in0_mode;
}

bool ttl_in_force(int number)
{
    const struct ttl_in_mode *mode = find(number);

    if (mode == NULL)
        return false;
    forced = number;
    change(mode);
    return true;
}

void ttl_in_restore(void)
{
    if (forced == NOT_FORCED)
        return;
    forced = NOT_FORCED;
    change(find((int)in0_mode));
}

/* Another number whenever an axis has begun something. */
static uint32_t motion_generation(void)
{
    uint32_t sum = 0;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        sum += axis_generation(axis);
    return sum;
}

/* Plan the next step ahead, if it is not. */
static void look_ahead(void)
{
    struct ttl_step step;

    stale = false;
    seen_generation = motion_generation();
    if (present->step == NULL || !present->step(&step) ||
        !move_prepare(step.owner, step.axes, step.target_counts))
        motion_unprepare();
}

bool ttl_in_trigger(void)
{
    struct ttl_step step;
    bool begun, steps;

    if (stale && motion_is_prepared())
        look_ahead();
    begun = motion_trigger();
    steps = begun || (present->step != NULL && present->step(&step));
    if (steps && (begun || move_to(step.owner, step.axes, step.target_counts))) {
        if (present->stepped != NULL)
            present->stepped();
    } else if (!steps && present->trigger != NULL) {
        present->trigger();
    }
    stale = true;
    return true;
}

static void triggered(const struct event *event)
{
    if (event->argument != 0)
        (void)ttl_in_trigger();
}

/* A line is carried out, or something else happens that may change what the next step is. In whatever
 * context: no step that was planned before begins by itself from here on. */
static void something_happens(const struct event *event)
{
    (void)event;
    stale = true;
    motion_doubt_prepared();
}

static bool all_stand(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (!motion_stands(axis) && motion_enabled(axis))
            return false;
    return true;
}

static bool must_look_ahead(void)
{
    return present->step != NULL && (stale || motion_generation() != seen_generation) && all_stand();
}

/* --- Profile ----------------------------------------------------------------------------------- */

/* The lines of BUILD X: what the original's builds with these inputs name. */
static const char *build_lines[3];

static void set_profile(unsigned axis, double value)
{
    static const char *const names[TTL_PROFILES][2] = {
        [TTL_PROFILE_ALL] = {"IN0_INT", "ENC_INT"},
        [TTL_PROFILE_IN0_INT] = {"IN0_INT"},
        [TTL_PROFILE_ENC_INT] = {"ENC_INT"},
        [TTL_PROFILE_REPORT_INT] = {"TTL_REPORT_INT"},
    };

    (void)axis;
    build_lines[0] = names[(int)value][0];
    build_lines[1] = names[(int)value][1];
    if (find((int)in0_mode) == NULL)
        in0_mode = 0;
    if (forced == NOT_FORCED)
        change(find((int)in0_mode));
}

/* --- Repeated moves and timed reports ---------------------------------------------------------- */

bool ttl_in_repeat(struct ttl_step *step)
{
    step->owner = &repeat_owner;
    step->axes = 0;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const int32_t by_counts = move_relative_counts(axis);

        step->target_counts[axis] = motion_target_counts(axis) + by_counts;
        if (by_counts != 0)
            step->axes |= MOTION_AXIS(axis);
    }
    return step->axes != 0;
}

void ttl_in_report(void)
{
    reporting = true;
    report_due_fast = events_now();
}

void ttl_in_report_end(void)
{
    reporting = false;
}

static void halted(const struct event *event)
{
    (void)event;
    reporting = false;
}

/* The plan costs up to a millisecond an axis: it is made once the axes stand, and again only when the
 * step has become another. */
static void poll(void)
{
    if (must_look_ahead())
        look_ahead();
    if (reporting && events_now() >= report_due_fast) {
        report_due_fast += (uint64_t)(report_ms * EVENTS_FAST_PER_MS);
        positions_report(ring_buffer_axes());
    }
}

static void init(void)
{
    reporting = false;
    ttl_in_restore();
}

static const struct parameter parameters[] = {
    /* Before TTL X: settings are taken in this order, and the profile says which modes there are. */
    {
        .command = "BUILD", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = TTL_PROFILES - 1, .initial = TTL_PROFILE_ALL, .value = &profile,
        .set = set_profile, .saved = SAVED_BY_SS,
        .summary = "The build of the original that the TTL input is taken for: 0 all in one; 1 "
                   "IN0_INT, without pixel pulses; 2 ENC_INT, TTL X=1 gives pixel pulses and there "
                   "is no other mode; 3 TTL_REPORT_INT, reports and no other mode.",
    },
    {
        .command = "TTL", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 255, .initial = 0, .value = &in0_mode, .check = check_in0_mode,
        .set = set_in0_mode, .get = get_in0_mode, .saved = SAVED_BY_SS,
        .summary = "A rising edge at IN0: 0 nothing; 1 next point of the ring buffer, and the "
                   "pixels of a scan give pulses; 2 repeats the last MOVREL; 4 a step of the "
                   "Z-stack; 5 starts timed reports of positions; 6 starts a scan, and its pixels "
                   "give pulses; 10 toggles OUT0; 12 next point of the ring buffer as a distance.",
    },
    {
        .command = "RTIME", .letter = 'X', .type = PARAMETER_INTEGER, .unit = "ms",
        .minimum = 20, .maximum = 32700, .initial = 200, .value = &report_ms,
        .saved = SAVED_BY_SS, .summary = "Time between timed reports (TTL X=5).",
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_HALT, EVENT_IN_MAIN, halted},
    {EVENT_TRIGGER_IN, EVENT_IN_MAIN, triggered},
    {EVENT_COMMAND, EVENT_IN_INTERRUPT, something_happens},
    {EVENT_BUTTON, EVENT_IN_INTERRUPT, something_happens},
    {EVENT_ORIGIN_MOVED, EVENT_IN_INTERRUPT, something_happens},
    {0},
};

const struct module ttl_in_module = {
    .name = "ttl in", .parameters = parameters, .subscriptions = subscriptions,
    .build_lines = build_lines, .init = init, .poll = poll,
};
