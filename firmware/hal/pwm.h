/* SPDX-License-Identifier: BSD-2-Clause */
/** Motor drive and the servo tick, which is an integer division of the PWM period. */
#ifndef HAL_PWM_H
#define HAL_PWM_H

#include <stdbool.h>
#include <stdint.h>

enum {
    PWM_AXES = 4,
    PWM_FULL_STEPS = 2500, /* duty of full drive; also the clocks of a period */
    PWM_PERIOD_US = 50,
};

/**
 * Set the duties of all axes, each -PWM_FULL_STEPS to PWM_FULL_STEPS. The gateware takes them
 * together: two PWM periods after the servo tick (register DutyDelay), at the next tick if that
 * comes earlier.
 */
void pwm_set_steps(const int32_t steps[PWM_AXES]);

/** Drive exactly these axes (bit mask); the others brake. */
void pwm_enable(uint32_t axes);

/** Servo tick every so many PWM periods, 1 to 255. */
void pwm_set_tick_periods(uint32_t periods);

/** Acknowledge the tick interrupt. True: a tick was missed since the last call. */
bool pwm_acknowledge_tick(void);

#endif
