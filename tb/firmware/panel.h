/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Hands on the host's registers: TTL inputs with their edges, buttons, knobs, joystick. Registers that hardware sets
 * and a written 1 clears behave so; the rest is memory.
 */
#ifndef TB_FIRMWARE_PANEL_H
#define TB_FIRMWARE_PANEL_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/buttons.h"
#include "hal/inputs.h"

/** Behind mmio_model_reset, in front of everything else here. */
void panel_start(void);

/** A TTL input goes to a level; its edge is kept, at this count of the timer. */
void panel_ttl(enum inputs_ttl pin, bool level, uint32_t at_cycles);

/** A press has ended, at this count of the timer. */
void panel_press(enum button button, enum button_length length, uint32_t at_cycles);

/** Level of an analog input, 0 to 1; the first call makes the converter answer. */
void panel_analog(unsigned channel, double level);

/** A knob has turned by edges. */
void panel_turn(unsigned knob, int edges);

#endif
