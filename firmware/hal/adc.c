/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/adc.h"

#include "regs.h"

_Static_assert(ADC_FULL == 1 << REG_ADC_CHANNEL0_VALUE_WIDTH, "resolution");

void adc_enable(void)
{
    adc_control_write(REG_ADC_CONTROL_ENABLE_MASK);
}

bool adc_valid(void)
{
    return adc_status_valid_get() != 0;
}

uint32_t adc_read(unsigned channel)
{
    return adc_channel_read(channel);
}
