/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Interrupt lines of the processor, and sleep. The target's is interrupts.c; the host build has its
 * own. Interrupts do not nest.
 */
#ifndef HAL_INTERRUPTS_H
#define HAL_INTERRUPTS_H

#include <stdbool.h>
#include <stdint.h>

/** Lines, as bits of a mask. */
enum {
    INTERRUPTS_TICK = 0x01,
    INTERRUPTS_SERIAL = 0x02,
    INTERRUPTS_TIMER = 0x04,
    INTERRUPTS_LINE = 0x08, /* compare: a line began, ended, or was armed too late */
    INTERRUPTS_BUS = 0x10,  /* a write that no register took */
    INTERRUPTS_REPORT = 0x20,
    INTERRUPTS_TRIGGER = 0x40,
};

/** Let these lines interrupt, and no others. */
void interrupts_enable(uint32_t lines);


/**
 * Sleep until the next interrupt, unless `busy` says that there is something to do. An interrupt
 * between the question and the sleep is not missed: `busy` is called with interrupts held, and a
 * held interrupt ends the sleep.
 */
void interrupts_sleep_unless(bool (*busy)(void));

#ifdef __riscv

/** Lines that are enabled and request now. For the dispatcher. */
static inline uint32_t interrupts_pending(void)
{
    uint32_t lines;

    __asm__ volatile("csrr %0, 0xfc0" : "=r"(lines) : : "memory");
    return lines;
}

/** Processor clocks, for measuring; stand still while the processor's clock is stopped. Wraps. */
static inline uint32_t interrupts_cycles(void)
{
    uint32_t cycles;

    __asm__ volatile("csrr %0, mcycle" : "=r"(cycles));
    return cycles;
}

#else

uint32_t interrupts_pending(void);
uint32_t interrupts_cycles(void);

#endif

#endif
