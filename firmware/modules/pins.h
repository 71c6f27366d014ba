/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The TTL outputs and who may say what about them: OUT0, SYNC and ENCODER through the pin router.
 *
 * SYNC always shows the active line. OUT0 shows a level. ENCODER shows pixel pulses or the raw
 * channel A of an axis. The polarity of OUT0 is that of the pixel pulses too, as both came out of
 * one connector on the original; channel A is never inverted.
 */
#ifndef MODULES_PINS_H
#define MODULES_PINS_H

#include <stdbool.h>

/** OUT0 high or low, before polarity. */
void pins_out0(bool high);

/** OUT0 shows the modulation of a lamp, until pins_out0; lit or dark is then its level. */
void pins_out0_lamp(bool lit);
bool pins_out0_is_lamp(void);

/** True inverts OUT0 and the pixel pulses. */
void pins_invert(bool inverted);

/** Level of the pin OUT0, after polarity. */
bool pins_out0_level(void);

/** Whether the pixels of a scan give pulses (TTL X=1). Taken when a scan starts. */
void pins_enable_pixels(bool enabled);
bool pins_pixels_enabled(void);

/** ENCODER: channel A of its axis (true) or pixel pulses. */
void pins_encoder_direct(bool direct);

/** OUT0 shows what ENCODER shows, in place of its level: the original's wiring. */
void pins_encoder_on_out0(bool on);

/** Axis of ENCODER, 0 to AXIS_COUNT - 1. Not during a scan line. */
void pins_encoder_axis(unsigned axis);

#endif
