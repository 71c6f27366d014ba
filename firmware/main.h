/* SPDX-License-Identifier: BSD-2-Clause */
/** What start.S calls. */
#ifndef MAIN_H
#define MAIN_H

#include <stdint.h>

/** After reset, with memory set up and interrupts off. Does not return. */
int main(void);

/** An interrupt: interrupts are off, and the caller-saved registers are saved. */
void main_interrupt(void);

/**
 * An exception, which here is always a bug: drives off, say so on the serial port, and stay.
 *
 * @param cause  mcause.
 * @param at     mepc.
 * @param value  mtval.
 */
void main_trap(uint32_t cause, uint32_t at, uint32_t value);

#endif
