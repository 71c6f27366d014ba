/* SPDX-License-Identifier: BSD-2-Clause */
/** The watchdog, the reset of the processor, and what survives it: registers keep what they hold, RAM too. */
#ifndef HAL_WATCHDOG_H
#define HAL_WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

/** Why the processor was last reset. */
enum watchdog_cause {
    WATCHDOG_POWER_UP,
    WATCHDOG_EXPIRED,
    WATCHDOG_COMMAND,
};

/** Start watching: from now on a kick is due every `timeout_ms`, at most 85 s, until the processor is reset. */
void watchdog_start(uint32_t timeout_ms);

/** All is well. 8 clocks. */
void watchdog_kick(void);

enum watchdog_cause watchdog_cause(void);

/** No program has called watchdog_set_warm since the gateware was loaded: RAM holds what came with it. */
bool watchdog_cold(void);
void watchdog_set_warm(void);

/** The drives go off and the processor is reset, within 32 clocks. */
void watchdog_reset_processor(void);

/** A word for the program that runs after a reset; 0 at power-up. */
uint32_t watchdog_scratch(void);
void watchdog_set_scratch(uint32_t word);

#endif
