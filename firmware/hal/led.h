/* SPDX-License-Identifier: BSD-2-Clause */
/** Modulation of a lamp; the pin router shows it (hal/router.h, ROUTER_LED). */
#ifndef HAL_LED_H
#define HAL_LED_H

#include <stdint.h>

/**
 * Length of a period and its high part, in fast clocks, together from the next period on; a dark one ends
 * at once. 4 to 2^21 - 1; 0 to the period.
 */
void led_set(uint32_t period_fast, uint32_t on_fast);

#endif
