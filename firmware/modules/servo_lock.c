/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/servo_lock.h"

#include <math.h>
#include <stdatomic.h>
#include <stddef.h>

#include "core/action.h"
#include "hal/classifier.h"
#include "modules/axis.h"
#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "modules/move.h"
#include "modules/ring_buffer.h"
#include "modules/ttl_in.h"
#include "modules/ttl_modes.h"
#include "servo/fence.h"

/* What LK F takes: T engages, Z disengages. */
enum { CODE_ENGAGE = 'T', CODE_DISENGAGE = 'Z' };

/* What LK X? answers, in CRISP's letters. */
enum { LETTER_ENGAGED = 'T', LETTER_IDLE = 'I' };

/* Decisions with which a tick takes no further batch, for up to two axes and for more: 110 000 a second
 * pass for ever, or 40 000, and axes at their fences have their time (docs/timing.md). */
enum { ENOUGH_FOR_TWO = 11, ENOUGH_FOR_MORE = 4 };

/* Ticks after which what crossed as the classifier stopped can be taken. */
#define TICKS_TO_DRAIN 2u

#define FAST_NS 5.0
#define COUNT_Q32 0x1p32
#define STEP_COUNTS_MAX 0x1p29

static double threshold_ms, range_mm, at_threshold, filter_ns;

/* The main loop's. `draining`: it ends once what waits has been taken. */
static bool engaged, draining;
static uint64_t stopped_tick;
static uint32_t lost_before; /* of the hardware, at the beginning */

/* The interrupt's while it is engaged, but for `steps`: written whole by the main loop, of two the one
 * that is not in use. */
struct axis_lock {
    struct fence fence;
    int64_t target_q32;
};
static unsigned axes, enough;
static struct axis_lock locks[AXIS_COUNT];
static int64_t steps_q32[2][AXIS_COUNT];
static const int64_t *volatile steps = steps_q32[0];
static volatile uint32_t pulses, clipped;

bool servo_lock_has(unsigned axis)
{
    return engaged && (axes & MOTION_AXIS(axis)) != 0;
}

/* --- The tick interrupt ------------------------------------------------------------------------ */

/* Decisions that wait, in a word with a 1 before them. */
static inline uint32_t take(void)
{
    uint32_t taken = 1, batch;

    while (taken >> enough == 0 && (batch = classifier_take()) > 1) {
        uint32_t first = 2; /* above the first decision */

        for (taken <<= 1; batch >= 2 * first; first <<= 1)
            taken <<= 1;
        taken |= batch ^ first;
    }
    return taken;
}

static void tick(void)
{
    const struct decisions taken = fence_decisions(take());
    const int64_t *const by_q32 = steps;
    uint32_t cut = 0;

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        struct axis_lock *lock = &locks[axis];

        if ((axes & MOTION_AXIS(axis)) == 0)
            continue;
        if (taken.count != 0 && by_q32[axis] != 0)
            cut |= fence_walk(&lock->fence, &lock->target_q32, by_q32[axis], &taken);
        axis_aim(axis, lock->target_q32);
    }
    pulses = pulses + taken.count;
    for (; cut != 0; cut &= cut - 1)
        clipped = clipped + 1;
}

/* --- Begin and end ----------------------------------------------------------------------------- */

static bool yield(unsigned axis, const struct motion_owner *to)
{
    (void)axis;
    (void)to;
    return false;
}

static void disengage(void)
{
    if (!engaged)
        return;
    axis_set_source(NULL);
    classifier_stop();
    move_take_relative(NULL);
    ttl_in_restore();
    engaged = false;
    draining = false;
}

/* HALT, a limit switch, MC-, the emergency stop, a fault: whatever ends it, ends it for all axes. */
static void ended(unsigned axis, enum motion_end why);

static const struct motion_owner owner = {
    .name = "servo lock", .busy = true, .letter = 'K', .yield = yield, .ended = ended,
};

static void let_go(void)
{
    const unsigned had = axes;

    disengage();
    motion_release(had, &owner);
}

static void ended(unsigned axis, enum motion_end why)
{
    (void)axis;
    (void)why;
    let_go();
}

static void set_steps(void)
{
    int64_t *const spare = steps == steps_q32[0] ? steps_q32[1] : steps_q32[0];

    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        spare[axis] = llround(fmax(-STEP_COUNTS_MAX,
                                   fmin(STEP_COUNTS_MAX, move_relative_part_counts(axis))) *
                              COUNT_Q32);
    atomic_signal_fence(memory_order_release);
    steps = spare;
}

static uint32_t threshold_fast(void)
{
    return (uint32_t)llround(threshold_ms * EVENTS_FAST_PER_MS);
}

static struct classifier_settings settings(void)
{
    return (struct classifier_settings){
        .threshold_fast = threshold_fast(),
        .filter_fast = (uint32_t)llround(filter_ns / FAST_NS),
        .at_threshold = at_threshold != 0,
    };
}

/* Where the axis is told to be: at rest, or at the end of a commanded move. */
static bool may_lock(unsigned axis)
{
    return motion_ready(axis) && (motion_stands(axis) || motion_axis_busy(axis));
}

static void fence_in(unsigned axis)
{
    const int32_t origin = motion_target_counts(axis);
    const double range = fmin(range_mm * coordinates_counts_per_mm(axis), COORDINATES_COUNTS_MAX);
    const double low = fmax(origin - range, -COORDINATES_COUNTS_MAX);
    const double high = fmin(origin + range, COORDINATES_COUNTS_MAX);
    const int32_t lowest = limits_nearest(axis, origin, (int32_t)floor(low));
    const int32_t highest = limits_nearest(axis, origin, (int32_t)ceil(high));

    locks[axis] = (struct axis_lock){
        .fence = {.low_q32 = llround(fmax(low, lowest) * COUNT_Q32),
                  .high_q32 = llround(fmin(high, highest) * COUNT_Q32)},
        .target_q32 = (int64_t)origin * (INT64_C(1) << 32),
    };
}

static bool engage(void)
{
    const struct classifier_settings wanted = settings();

    if (engaged)
        return !draining;
    axes = ring_buffer_axes();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0 && !may_lock(axis))
            return false;
    if (axes == 0 || !motion_claim(axes, &owner))
        return false;
    if (!ttl_in_force(TTL_IN_SERVO_LOCK)) {
        motion_release(axes, &owner);
        return false;
    }
    enough = ENOUGH_FOR_TWO;
    for (unsigned axis = 0, count = 0; axis < AXIS_COUNT; axis++)
        if ((axes & MOTION_AXIS(axis)) != 0) {
            fence_in(axis);
            if (++count > 2)
                enough = ENOUGH_FOR_MORE;
        }
    set_steps();
    move_take_relative(set_steps);
    pulses = 0;
    clipped = 0;
    lost_before = classifier_lost();
    engaged = true;
    axis_set_source(tick);
    classifier_start(&wanted);
    return true;
}

/* Pulses that ended before this still count: a few ticks later it is over. */
static void leave(void)
{
    if (!engaged || draining)
        return;
    classifier_stop();
    stopped_tick = axis_ticks();
    draining = true;
}


bool servo_lock_toggle(void)
{
    if (!engaged)
        return engage();
    leave();
    return true;
}

static void poll(void)
{
    if (draining && axis_ticks() - stopped_tick >= TICKS_TO_DRAIN && classifier_waiting() == 0)
        let_go();
}

static void init(void)
{
    engaged = false;
    draining = false;
    axes = 0;
    axis_set_source(NULL);
    move_take_relative(NULL);
    classifier_stop();
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
        reply_char(reply, engaged ? LETTER_ENGAGED : LETTER_IDLE);
        return STATUS_OK;
    }
    if (code == NULL)
        return action_perform(ACTION_LOCK) ? STATUS_OK : STATUS_FAILED;
    if (code->value == CODE_ENGAGE)
        return engage() ? STATUS_OK : STATUS_FAILED;
    leave();
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
    if (engaged)
        set_steps();
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
    return pulses;
}

static double get_clipped(unsigned axis)
{
    (void)axis;
    return clipped;
}

static double get_lost(unsigned axis)
{
    (void)axis;
    return classifier_lost() - lost_before;
}

/* --- Settings ---------------------------------------------------------------------------------- */

static void configure(unsigned axis, double value)
{
    const struct classifier_settings wanted = settings();

    (void)axis;
    (void)value;
    if (engaged && !draining)
        classifier_configure(&wanted);
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
    .build_lines = build_lines, .init = init, .poll = poll,
};
