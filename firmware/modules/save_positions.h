/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * SAVEPOS: positions outlive the power. `SP` stops the axes, stores where they are, and leaves the
 * controller deaf until its power is cycled; the next power-up starts from there, once.
 */
#ifndef MODULES_SAVE_POSITIONS_H
#define MODULES_SAVE_POSITIONS_H

#include "core/module.h"

extern const struct module save_positions_module;

/** True from the acknowledge of SP on: nothing is to be carried out any more. */
bool save_positions_is_down(void);

/** Keep limits and home anew, from the 0 and in the scale that hold now. False: not kept. */
bool save_positions_keep_places(void);

/**
 * Power-up, once, before the settings are loaded: give the axes their stored coordinates, if there
 * are any, and forget them, as they hold for one power-up.
 */
void save_positions_restore(void);

#endif
