/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/spin.h"

#include <math.h>
#include <stddef.h>

#include "core/fault.h"
#include "hal/pwm.h"
#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/motion.h"

/* Rates are in steps of a converter the original had: 128 is full drive, and its 127 as well. */
#define RATE_MAX 128.0

static void stop(unsigned axis, enum motion_end why);

/* Busy, so that hosts which home by it see it end; but no commanded move that HALT answers for. */
static const struct motion_owner owner = {
    .name = "spin", .busy = true, .holds = true, .open_loop = true, .letter = 'S', .ended = stop,
};

/* Direction in counts, 0: at rest. */
static int direction[AXIS_COUNT];

static void stop(unsigned axis, enum motion_end why)
{
    (void)why;
    direction[axis] = 0;
    axis_spin(axis, 0);
    motion_release(MOTION_AXIS(axis), &owner);
}

static void drive(unsigned axis, double rate)
{
    double share = fmax(-1, fmin(1, rate / (RATE_MAX - 1)));

    if (coordinates_mirrored(axis))
        share = -share;
    if (rate == 0) {
        if (motion_owner(axis) == &owner)
            stop(axis, MOTION_HALTED);
    } else if (motion_ready(axis)) {
        motion_stop(MOTION_AXIS(axis));
        direction[axis] = share > 0 ? 1 : -1;
        axis_spin(axis, (int32_t)lround(share * PWM_FULL_STEPS));
    } else {
        motion_release(MOTION_AXIS(axis), &owner);
    }
}

static enum status spin(const struct request *request, struct reply *reply)
{
    unsigned driven = 0;

    (void)reply;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        if (argument != NULL && !(fabs(argument->value) <= RATE_MAX))
            return STATUS_RANGE;
        if (argument != NULL && argument->value != 0)
            driven |= MOTION_AXIS(axis);
    }
    if (!motion_claim(driven, &owner))
        return STATUS_FAILED;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct argument *argument = request_argument(request, axis_letter(axis));

        if (argument != NULL)
            drive(axis, argument->value);
    }
    return STATUS_OK;
}

/* Soft limits; the interrupt sees to the switches. */
static void poll(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        int32_t at;

        if (direction[axis] == 0)
            continue;
        at = motion_position_counts(axis);
        if (direction[axis] > 0 ? limits_at_upper(axis, at) : limits_at_lower(axis, at)) {
            log_error((uint16_t)limits_fault(axis, direction[axis] > 0));
            stop(axis, MOTION_LIMIT);
        }
    }
}

static void init(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        direction[axis] = 0;
}

static const struct command commands[] = {
    {
        .name = "SPIN", .shortcut = "@", .flags = COMMAND_NEEDS_ARGUMENT, .run = spin,
        .summary = "Drive axes open loop, -128 to 128 of 128ths of full drive; 0 or no value stops.",
        .accepts = ARGUMENT_BARE | ARGUMENT_VALUE,
    },
    {0},
};

const struct module spin_module = {
    .name = "spin", .commands = commands, .init = init, .poll = poll,
};
