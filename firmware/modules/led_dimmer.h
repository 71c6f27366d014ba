/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * LED DIMMER: brightness of a lamp that is gated by OUT0, by pulse-width modulation (LED, TTL Y=9).
 *
 * Every period at the pin is whole: light begins with a period, and a change with the next one. Darkness
 * by another mode of OUT0 is at once.
 */
#ifndef MODULES_LED_DIMMER_H
#define MODULES_LED_DIMMER_H

#include "core/module.h"

extern const struct module led_dimmer_module;

/** TTL Y=9 is selected; or another mode, which gives OUT0 its level itself. */
void led_dimmer_on(void);
void led_dimmer_off(void);

/** Judge a line of TTL: a number without a letter goes with Y=9 only, as the brightness. */
enum status led_dimmer_check(const struct request *request);

#endif
