/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/timer.h"

#include "regs.h"

uint32_t timer_now_cycles(void)
{
    return timer_count_read();
}

uint64_t timer_time_cycles(void)
{
    timer_control_write(REG_TIMER_CONTROL_LATCH_MASK);
    return (uint64_t)timer_latched_high_read() << 32 | timer_latched_low_read();
}

void timer_alarm_at(uint32_t at_cycles)
{
    timer_alarm_write(at_cycles);
    timer_control_write(REG_TIMER_CONTROL_ARM_MASK);
}

void timer_cancel(void)
{
    timer_control_write(REG_TIMER_CONTROL_CANCEL_MASK);
}

void timer_acknowledge(void)
{
    timer_interrupt_write(REG_TIMER_INTERRUPT_ALARM_MASK);
}
