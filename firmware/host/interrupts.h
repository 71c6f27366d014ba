/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Interrupts of the host build. Nothing preempts: a model raises lines, and they are served when
 * the firmware sleeps or when a test says so.
 */
#ifndef HOST_INTERRUPTS_H
#define HOST_INTERRUPTS_H

#include <stdint.h>

/** Levels of the interrupt lines, as the model drives them. */
void host_interrupts_set(uint32_t lines);

/** What stands in for waiting: moves the model on until some line may have risen. NULL: nothing. */
void host_interrupts_on_sleep(void (*wait)(void));

/** The dispatcher to call for lines that are enabled and high; the firmware's own. */
void host_interrupts_dispatch(void (*dispatch)(void));

/** Serve lines that are enabled and high, at most 16 times. */
void host_interrupts_serve(void);

/** What interrupts_cycles answers. */
void host_interrupts_set_cycles(uint32_t cycles);

#endif
