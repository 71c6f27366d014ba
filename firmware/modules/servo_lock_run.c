/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/servo_lock_run.h"

#include <math.h>
#include <stdatomic.h>
#include <stddef.h>

#include "modules/axis.h"
#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "modules/move.h"
#include "modules/ring_buffer.h"
#include "modules/ttl_in.h"
#include "modules/ttl_modes.h"
#include "servo/fence.h"

/* Decisions with which a tick takes no further batch, for up to two axes and for more: 110 000 a second
 * pass for ever, or 40 000, and axes at their fences have their time (docs/timing.md). */
enum { ENOUGH_FOR_TWO = 11, ENOUGH_FOR_MORE = 4 };

/* Ticks after which what crossed as the classifier stopped can be taken. */
#define TICKS_TO_DRAIN 2u

#define COUNT_Q32 0x1p32
#define STEP_COUNTS_MAX 0x1p29

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

bool servo_lock_engaged(void)
{
    return engaged;
}

struct servo_lock_counts servo_lock_counts(void)
{
    return (struct servo_lock_counts){
        .pulses = pulses, .clipped = clipped, .lost = classifier_lost() - lost_before,
    };
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

/* Where the axis is told to be: at rest, or at the end of a commanded move. */
static bool may_lock(unsigned axis)
{
    return motion_ready(axis) && (motion_stands(axis) || motion_axis_busy(axis));
}

static void fence_in(unsigned axis, double range_mm)
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

bool servo_lock_engage(const struct classifier_settings *pulse, double range_mm)
{
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
            fence_in(axis, range_mm);
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
    classifier_start(pulse);
    return true;
}

void servo_lock_leave(void)
{
    if (!engaged || draining)
        return;
    classifier_stop();
    stopped_tick = axis_ticks();
    draining = true;
}

void servo_lock_configure(const struct classifier_settings *pulse)
{
    if (engaged && !draining)
        classifier_configure(pulse);
}

void servo_lock_steps_changed(void)
{
    if (engaged)
        set_steps();
}

void servo_lock_poll(void)
{
    if (draining && axis_ticks() - stopped_tick >= TICKS_TO_DRAIN && classifier_waiting() == 0)
        let_go();
}

void servo_lock_init(void)
{
    engaged = false;
    draining = false;
    axes = 0;
    axis_set_source(NULL);
    move_take_relative(NULL);
    classifier_stop();
}
