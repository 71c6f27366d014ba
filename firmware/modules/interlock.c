/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The gateware has taken the drive off an axis already (hal/interlock.h). Here the axis is switched off, so that
 * nothing goes on when the fault is cleared, and the error log gets its code. MC axis+ takes it back.
 *
 *     illegal transitions of an encoder     24
 *     no progress                           20 + axis, as an axis that does not move
 *     too fast                              30 + axis, as one that runs away
 *     too far from its set-point            50 + axis, as an error that is too large
 *     reset of a processor that hung        48
 */
#include "modules/interlock.h"

#include <math.h>
#include <stddef.h>

#include "core/axis.h"
#include "core/fault.h"
#include "hal/interlock.h"
#include "hal/watchdog.h"
#include "modules/axis.h"
#include "modules/motion.h"
#include "modules/screw.h"

/* Drive that moves an axis at rest, over that which keeps it moving (KF), and a little more: what is asked
 * to move must be sure to. */
#define BREAKAWAY_SHARE 1.52
#define BREAKAWAY_STEPS_LEAST 100.0

/*
 * Time in which strong drive from rest makes way: the winding's and the friction's at the start, then that of a
 * constant acceleration, with a margin of 1.28 for a motor that is not quite the one it is taken for. 0.96 ms
 * with the default gains. A motor that is being measured may be slower by far.
 */
#define START_MS 0.41
#define START_MARGIN 1.28
#define STRONG_MS_LEAST 0.9
#define STRONG_MS_MOST 5.0

/* Twice the speed that the screw is for. */
#define SPEED_SHARE 2.0
#define SPEED_WINDOW_S 100e-6

/* RUNAWAY judges by the direction, this by the distance alone; a weak motor may fall far behind. */
#define FOLLOWING_SHARE 8.0

/* What the pins did before the start is no fault: as long as it may be a cause. */
#define START_TICKS (20000u / AXIS_TICK_US)

static struct interlock_motor motors[AXIS_COUNT];
static bool measured[AXIS_COUNT];
static uint32_t seen; /* faults that are known */

static double strong_ms(const struct interlock_motor *motor)
{
    const double force_steps = fmax(1, INTERLOCK_STRONG_STEPS - motor->friction_steps);
    const double start_ms = START_MARGIN * sqrt(2 * INTERLOCK_WAY_COUNTS *
                                                motor->inertia_steps_per_counts_per_ms2 / force_steps);

    return fmin(STRONG_MS_MOST, fmax(STRONG_MS_LEAST, START_MS + start_ms));
}

static void limit(unsigned axis)
{
    const struct interlock_motor *motor = &motors[axis];
    const struct screw *screw = screw_of(axis);
    const struct interlock_limits limits = {
        .strong_time_half_us = (uint32_t)(2000 * (measured[axis] ? STRONG_MS_MOST : strong_ms(motor))),
        .breakaway_steps = (uint32_t)fmin(4095, fmax(BREAKAWAY_STEPS_LEAST,
                                                     BREAKAWAY_SHARE * motor->friction_steps)),
        .speed_counts = (uint32_t)ceil(SPEED_SHARE * SPEED_WINDOW_S * screw->speed_max_mm_per_s *
                                       screw->counts_per_mm),
        .following_counts = (uint32_t)fmin(INT32_MAX, FOLLOWING_SHARE * motor->runaway_counts),
    };

    interlock_limit(axis, &limits);
}

void interlock_set_motor(unsigned axis, const struct interlock_motor *motor)
{
    motors[axis] = *motor;
    limit(axis);
}

void interlock_measure(unsigned axis, bool is_measured)
{
    measured[axis] = is_measured;
    limit(axis);
}

bool interlock_is_blocked(unsigned axis)
{
    return interlock_of_axis(interlock_faults() & interlock_causes(), axis) != 0;
}

void interlock_release(unsigned axis)
{
    (void)interlock_clear(axis);
    seen &= interlock_faults();
}

static void report(unsigned axis, uint32_t faults)
{
    static const struct {
        uint32_t fault;
        enum fault code;
        bool of_axis;
    } codes[] = {
        {INTERLOCK_ILLEGAL, FAULT_ENCODER, false},
        {INTERLOCK_NO_PROGRESS, FAULT_AXIS_DEAD, true},
        {INTERLOCK_OVER_SPEED, FAULT_RUNAWAY, true},
        {INTERLOCK_FOLLOWING, FAULT_ENCODER_OVERFLOW, true},
    };

    for (size_t n = 0; n < sizeof codes / sizeof codes[0]; n++)
        if ((faults & codes[n].fault) != 0)
            log_error((uint16_t)(codes[n].code + (codes[n].of_axis ? axis : 0)));
    motion_fail(axis);
}

static void init(void)
{
    seen = 0;
    if (interlock_take_reset() && watchdog_cause() == WATCHDOG_EXPIRED)
        log_error(FAULT_TASK_OVERTIME);
}

static void poll(void)
{
    const uint32_t faults = interlock_faults(), news = faults & ~seen;

    if (axis_ticks() < START_TICKS) {
        for (unsigned axis = 0; axis < AXIS_COUNT && faults != 0; axis++)
            (void)interlock_clear(axis);
        return;
    }
    seen |= faults;
    for (unsigned axis = 0; axis < AXIS_COUNT && news != 0; axis++)
        if (interlock_of_axis(news, axis) != 0)
            report(axis, interlock_of_axis(news, axis));
}

const struct module interlock_module = {
    .name = "interlock", .init = init, .poll = poll,
};
