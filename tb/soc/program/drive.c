/* SPDX-License-Identifier: BSD-2-Clause */
/* Drives two axes, and from then on does nothing but to write the same again and again, as fast as the bus takes it. */
#include "regs.h"

void program(void);
uint32_t trap(uint32_t cause, uint32_t epc, uint32_t value, uint32_t at, uint32_t ra);

uint32_t trap(uint32_t cause, uint32_t epc, uint32_t value, uint32_t at, uint32_t ra)
{
    (void)cause, (void)value, (void)at, (void)ra;
    return epc;
}

void program(void)
{
    interlock_clear_write(~0u);
    pwm_control_write(3);
    for (;;) {
        pwm_duty_write(0, 2000);
        pwm_duty_write(1, 300);
        (void)interlock_faults_read();
        interlock_drive_time_write(38000);
    }
}
