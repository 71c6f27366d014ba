/* SPDX-License-Identifier: BSD-2-Clause */
/** RING BUFFER: stored places, gone to one after the other. LOAD, RBMODE, RTIME Z. */
#ifndef MODULES_RING_BUFFER_H
#define MODULES_RING_BUFFER_H

#include "core/module.h"

/** Points it holds, as BUILD X says. */
#define RING_BUFFER_POINTS 50

extern const struct module ring_buffer_module;

/* Steps of a trigger, for the table in ttl_modes.c: points are places, or distances. */
struct ttl_step;
bool ring_buffer_step(struct ttl_step *step);
bool ring_buffer_step_relative(struct ttl_step *step);
void ring_buffer_stepped(void);
void ring_buffer_stepped_relative(void);

/** A trigger that has no step: ends going by itself. */
void ring_buffer_trigger(void);

/** Axes that move, as a mask: RBMODE Y. They are also the ones that timed reports name. */
unsigned ring_buffer_axes(void);

/** Claims of buttons: @ goes on, a long press of the joystick stores, a long HOME clears. */
bool ring_buffer_button_next(void);
bool ring_buffer_button_store(void);
bool ring_buffer_button_clear(void);

#endif
