/* SPDX-License-Identifier: BSD-2-Clause */
/** RING BUFFER: stored places, gone to one after the other. LOAD, RBMODE, RTIME Z. */
#ifndef MODULES_RING_BUFFER_H
#define MODULES_RING_BUFFER_H

#include "core/module.h"

/** Points it holds, as BUILD X says. */
#define RING_BUFFER_POINTS 50

extern const struct module ring_buffer_module;

/**
 * A trigger: go to the next point, or start or stop going round by itself, as RBMODE F says. Points
 * are places, or distances.
 */
void ring_buffer_trigger(void);
void ring_buffer_trigger_relative(void);

/** Axes that move, as a mask: RBMODE Y. They are also the ones that timed reports name. */
unsigned ring_buffer_axes(void);

/** Claims of buttons: @ goes on, a long press of the joystick stores, a long HOME clears. */
bool ring_buffer_button_next(void);
bool ring_buffer_button_store(void);
bool ring_buffer_button_clear(void);

#endif
