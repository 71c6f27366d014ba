/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Joystick and hand-wheels: axes moved by hand (JOYSTICK, JSSPD).
 *
 * A deflected joystick drives its axis at a speed, with the ramp of ACCEL, until it is let go; it
 * stops at the soft limits. A wheel moves its axis by a distance for each edge. Neither is a
 * commanded move: STATUS says N. A commanded move is not disturbed by a hand; a hand's motion ends
 * when a move is commanded. After a HALT, a limit or a move the joystick does nothing until it has
 * been let go, or pulled the other way.
 */
#ifndef MODULES_JOYSTICK_H
#define MODULES_JOYSTICK_H

#include <stdbool.h>

#include "core/module.h"

extern const struct module joystick_module;

/** An input device is connected to the axis: bit 3 of RDSTAT. */
bool joystick_connected(unsigned axis);

/** Name of that device, as INFO prints it. */
const char *joystick_device_name(unsigned axis);

/** The joystick's button: fast or slow. */
bool joystick_toggle_speed(void);

/** The control knob from its axis to the last axis, and back; not saved. */
void joystick_toggle_knob(void);

#endif
