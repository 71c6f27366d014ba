/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/interlock.h"

#include "regs.h"

/* The fields of the axes lie one behind the other, in the order of the enum. */
_Static_assert(REG_INTERLOCK_FAULTS_ILLEGAL_SHIFT == 0 && REG_INTERLOCK_FAULTS_NO_PROGRESS_SHIFT == 4 &&
                   REG_INTERLOCK_FAULTS_OVER_SPEED_SHIFT == 8 && REG_INTERLOCK_FAULTS_FOLLOWING_SHIFT == 12 &&
                   REG_INTERLOCK_FAULTS_FOLLOWING_WIDTH == INTERLOCK_AXES,
               "faults by axis");

_Static_assert(INTERLOCK_STRONG_STEPS == REG_INTERLOCK_STRONG_VALUE_RESET &&
                   INTERLOCK_WAY_COUNTS == REG_INTERLOCK_WAY_COUNTS_RESET,
               "limits that stay as they are at reset");

#define OF_AXES 0xffffu
#define OF_AXIS(axis) (0x1111u << (axis))

void interlock_limit(unsigned axis, const struct interlock_limits *limits)
{
    interlock_strong_time_write(axis, limits->strong_time_half_us);
    interlock_breakaway_write(axis, limits->breakaway_steps);
    interlock_speed_most_write(axis, limits->speed_counts);
    interlock_following_most_write(axis, limits->following_counts);
}

uint32_t interlock_faults(void)
{
    return interlock_faults_read() & OF_AXES;
}

uint32_t interlock_causes(void)
{
    return interlock_causes_read() & OF_AXES;
}

uint32_t interlock_of_axis(uint32_t faults, unsigned axis)
{
    const uint32_t bits = faults >> axis;

    return (bits & 1u) | (bits >> 3 & 2u) | (bits >> 6 & 4u) | (bits >> 9 & 8u);
}

bool interlock_clear(unsigned axis)
{
    interlock_clear_write(OF_AXIS(axis));
    return (interlock_faults_read() & OF_AXIS(axis)) == 0;
}

bool interlock_take_reset(void)
{
    const bool was = interlock_faults_watchdog_get() != 0;

    interlock_clear_write(REG_INTERLOCK_CLEAR_WATCHDOG_MASK | REG_INTERLOCK_CLEAR_ESTOP_MASK);
    return was;
}

void interlock_watch(uint32_t armed, uint32_t hold)
{
    interlock_control_write(armed << REG_INTERLOCK_CONTROL_ARMED_SHIFT |
                            hold << REG_INTERLOCK_CONTROL_HOLD_SHIFT);
}

void interlock_expect(const int32_t position_counts[INTERLOCK_AXES])
{
    for (unsigned axis = 0; axis < INTERLOCK_AXES; axis++)
        interlock_expected_write(axis, position_counts[axis]);
}
