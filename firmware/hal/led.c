/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/led.h"

#include "regs.h"

void led_set(uint32_t period_fast, uint32_t on_fast)
{
    led_period_write(period_fast);
    led_on_write(on_fast);
    led_control_write(REG_LED_CONTROL_LOAD_MASK);
}
