/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The firmware as a whole: start-up, one turn of the main loop, and the interrupt. main.c runs it
 * on the target; the host build runs the same over a model of the registers.
 */
#ifndef MODULES_APPLICATION_H
#define MODULES_APPLICATION_H

#include <stdbool.h>

#include "core/module.h"

/**
 * Start everything: the servo tick, the settings, the modules, the serial port, the interrupts.
 *
 * @return  False, with nothing started, when the gateware is not one this firmware knows. It has
 *          been said on the serial port.
 */
bool application_init(void);

/** RESET, and what the processor does for other reasons than modules. */
extern const struct module application_module;

/** One turn of the main loop. */
void application_poll(void);

/** The main loop comes round: said at each turn, and to be said by what keeps it from coming, within a second. */
void application_alive(void);

/** Whether another turn is due; without other reasons, once a millisecond. */
bool application_busy(void);

/** Serve all interrupt lines that request. */
void application_interrupt(void);

#endif
