/* SPDX-License-Identifier: BSD-2-Clause */
/** Eight analog inputs, taken together at the last servo tick. */
#ifndef HAL_ADC_H
#define HAL_ADC_H

#include <stdbool.h>
#include <stdint.h>

enum { ADC_CHANNELS = 8, ADC_FULL = 4096 };

/** Scan all channels after each servo tick, from the next on. */
void adc_enable(void);

/** The converter answers: the values are of the servo period before the last tick. */
bool adc_valid(void);

/** A channel, 0 to ADC_FULL - 1; the last that was valid, 0 when none was. */
uint32_t adc_read(unsigned channel);

#endif
