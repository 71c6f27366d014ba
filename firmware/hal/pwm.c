/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/pwm.h"

#include "regs.h"

void pwm_set_steps(const int32_t steps[PWM_AXES])
{
    for (unsigned axis = 0; axis < PWM_AXES; axis++)
        pwm_duty_write(axis, steps[axis]);
}

void pwm_enable(uint32_t axes)
{
    pwm_control_write(axes);
}

void pwm_set_tick_periods(uint32_t periods)
{
    pwm_tick_divider_write(periods);
}

bool pwm_acknowledge_tick(void)
{
    uint32_t events = pwm_interrupt_read();

    pwm_interrupt_write(events);
    return (events & REG_PWM_INTERRUPT_OVERRUN_MASK) != 0;
}
