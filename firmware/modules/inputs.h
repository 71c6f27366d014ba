/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * TTL and analog inputs: edges become events (EVENT_TRIGGER_IN, EVENT_IN1), RDADC prints channels.
 * DIP switches 4, 5, 7 and 8: the rate of the serial port and the directions of X and Y.
 */
#ifndef MODULES_INPUTS_H
#define MODULES_INPUTS_H

#include <stdint.h>

#include "core/module.h"

extern const struct module inputs_module;

/** Rate of the serial port, by the switches or what stands in for them. */
uint32_t inputs_rate_bits_per_s(void);

/** The time of a stamp of an input, in fast clocks; to a microsecond, up to 85 s after it. */
uint64_t inputs_time_fast(uint32_t at_cycles);

#endif
