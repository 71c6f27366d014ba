/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/z_stack.h"

#include <stddef.h>

#include "modules/coordinates.h"
#include "modules/letters.h"
#include "modules/motion.h"
#include "modules/move.h"
#include "modules/ttl_modes.h"

/* ZS M. */
enum state { STATE_START = 0, STATE_UP = 1, STATE_DOWN = 2 };

static const struct motion_owner owner = {.name = "z stack", .busy = true, .letter = 'B'};

static double step_user, slices, triangle, timeout_ms;
static int32_t step_counts;
static uint64_t over_fast;

/* Where a stack is: its state, its slice, and its middle. */
struct place {
    enum state state;
    unsigned slice;
    int32_t centre_counts;
};

static struct place place, planned; /* planned: where the next trigger leads */

static int32_t clamp(int64_t counts)
{
    if (counts > COORDINATES_COUNTS_MAX)
        return COORDINATES_COUNTS_MAX;
    if (counts < -COORDINATES_COUNTS_MAX)
        return -COORDINATES_COUNTS_MAX;
    return (int32_t)counts;
}

/* The place after the present one. */
static struct place next_place(void)
{
    const unsigned last = (unsigned)slices - 1;
    struct place next = place;

    if (place.state == STATE_START) {
        next.centre_counts = motion_target_counts(letters_focus_axis());
        next.slice = 0;
        next.state = STATE_UP;
    } else if (last == 0) {
        next.slice = 0;
    } else if (triangle == 0) {
        next.slice = place.slice < last ? place.slice + 1 : 0;
    } else {
        if (place.slice >= last)
            next.state = STATE_DOWN;
        else if (place.slice == 0)
            next.state = STATE_UP;
        next.slice = next.state == STATE_UP ? place.slice + 1 : place.slice - 1;
    }
    return next;
}

/* The stack lies about its centre; halves of a step are rounded toward it. */
static int32_t counts_of(const struct place *at)
{
    const int64_t range = (int64_t)step_counts * ((int64_t)slices - 1);

    return clamp(at->centre_counts - range / 2 + (int64_t)step_counts * at->slice);
}

bool z_stack_step(struct ttl_step *step)
{
    const struct place next = next_place();
    const unsigned focus = letters_focus_axis();

    step->owner = &owner;
    step->axes = MOTION_AXIS(focus);
    step->target_counts[focus] = counts_of(&next);
    planned = next;
    return true;
}

void z_stack_stepped(void)
{
    place = planned;
    over_fast = events_now() + (uint64_t)(timeout_ms * EVENTS_FAST_PER_MS);
}

static void go_back(void)
{
    int32_t targets[AXIS_COUNT] = {0};

    targets[letters_focus_axis()] = place.centre_counts;
    (void)move_to(&owner, MOTION_AXIS(letters_focus_axis()), targets);
}

/* Leave the stack; back to where it began. */
static void leave(void)
{
    if (place.state != STATE_START)
        go_back();
    place.state = STATE_START;
    place.slice = 0;
}

static void poll(void)
{
    if (place.state != STATE_START && timeout_ms > 0 && events_now() >= over_fast)
        leave();
}

/* HALT leaves the stack, too, but where it stands. */
static void halted(const struct event *event)
{
    (void)event;
    place.state = STATE_START;
    place.slice = 0;
}

static void init(void)
{
    place.state = STATE_START;
    place.slice = 0;
}

/* Cut to whole counts, as the original does. */
static double adjust_step(unsigned axis, double value)
{
    (void)axis;
    const unsigned focus = letters_focus_axis();
    const double user_per_count =
        coordinates_units_per_mm(focus) / coordinates_counts_per_mm(focus);

    return (double)(int32_t)(value / user_per_count) * user_per_count;
}

static enum status check_step(unsigned axis, double value)
{
    (void)axis;
    return value == 0 || coordinates_fits(letters_focus_axis(), value) ? STATUS_OK : STATUS_RANGE;
}

/* The step is also what a repeated MOVREL does to the focus axis (TTL X=2). */
static void set_step(unsigned axis, double value)
{
    (void)axis;
    step_counts = coordinates_distance_to_counts(letters_focus_axis(), value);
    move_set_relative_counts(letters_focus_axis(), step_counts);
}

static double get_state(unsigned axis)
{
    (void)axis;
    return place.state;
}

static void set_state(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    leave();
}

unsigned z_stack_slice(void)
{
    return (unsigned)place.slice;
}

static double get_slice(unsigned axis)
{
    (void)axis;
    return place.slice;
}

static const struct command commands[] = {
    {
        .name = "ZS", .form = FORM_P,
        .summary = "A stack of slices about the present focus, one a pulse at IN0 (TTL X=4).",
    },
    {0},
};

static const struct parameter parameters[] = {
    {
        .command = "ZS", .letter = 'X', .type = PARAMETER_REAL, .decimals = 6, .unit = "user units",
        .minimum = -1e6, .maximum = 1e6, .initial = 0, .value = &step_user, .check = check_step,
        .taken = "-1e6 ... 1e6, within the range of the counts",
        .adjust = adjust_step, .set = set_step, .saved = SAVED_BY_SS,
        .summary = "From slice to slice, cut to whole counts; positive starts at the lower end.",
    },
    {
        .command = "ZS", .letter = 'Y', .type = PARAMETER_INTEGER, .unit = "slices",
        .minimum = 1, .maximum = 32767, .initial = 1, .value = &slices, .saved = SAVED_BY_SS,
        .summary = "Slices of the stack.",
    },
    {
        .command = "ZS", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &triangle, .saved = SAVED_BY_SS,
        .summary = "After the last slice: 0 the first again, 1 back slice by slice.",
    },
    {
        .command = "ZS", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "ms",
        .minimum = 0, .maximum = 32767, .initial = 500, .value = &timeout_ms,
        .saved = SAVED_BY_SS,
        .summary = "After so long without a pulse, back to where the stack began; 0: never.",
    },
    {
        .command = "ZS", .letter = 'M', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 0, .get = get_state, .set = set_state, .saved = SAVED_NEVER,
        .summary = "0 leaves the stack. Query: 0 not begun, 1 going up, 2 going down.",
    },
    {
        .command = "ZS", .letter = 'T', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 32766, .read_only = true, .get = get_slice,
        .saved = SAVED_NEVER, .summary = "Number of the present slice, from 0.",
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_HALT, EVENT_IN_MAIN, halted},
    {0},
};

const struct module z_stack_module = {
    .name = "z stack", .commands = commands, .parameters = parameters,
    .subscriptions = subscriptions, .init = init, .poll = poll,
};
