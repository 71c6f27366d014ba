/* SPDX-License-Identifier: BSD-2-Clause */
/** RING BUFFER: stored places, gone to one after the other. LOAD, RBMODE, RTIME Z. */
#ifndef MODULES_RING_BUFFER_H
#define MODULES_RING_BUFFER_H

#include "core/module.h"

/** Points it holds, as BUILD X says. */
#define RING_BUFFER_POINTS 50

extern const struct module ring_buffer_module;

/**
 * Go to the next point, or start or stop going round by itself, as RBMODE F says.
 *
 * @param relative  The point is a distance, not a place.
 * @return          False: no point is stored.
 */
bool ring_buffer_next(bool relative);

/** Axes that move, as a mask: RBMODE Y. They are also the ones that timed reports name. */
unsigned ring_buffer_axes(void);

/** Claims of buttons: @ goes on, a long press of the joystick stores, a long HOME clears. */
bool ring_buffer_button_next(void);
bool ring_buffer_button_store(void);
bool ring_buffer_button_clear(void);

#endif
