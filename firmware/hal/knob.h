/* SPDX-License-Identifier: BSD-2-Clause */
/** Hand-wheels. */
#ifndef HAL_KNOB_H
#define HAL_KNOB_H

#include <stdint.h>

enum knob { KNOB_CONTROL, KNOB_X, KNOB_Y, KNOB_COUNT };

/** Edges counted, up when channel A leads. Wraps at 16 bits: take differences modulo 2^16. */
int16_t knob_position(enum knob knob);

#endif
