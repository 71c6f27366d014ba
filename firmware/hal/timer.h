/* SPDX-License-Identifier: BSD-2-Clause */
/** A free-running count of system clocks, and one alarm. */
#ifndef HAL_TIMER_H
#define HAL_TIMER_H

#include <stdbool.h>
#include <stdint.h>

/** Low half of the count, for intervals; wraps after 85 s at 50 MHz. */
uint32_t timer_now_cycles(void);

/** The whole count. Main loop only: it latches. */
uint64_t timer_time_cycles(void);

/** Interrupt once, when the low half of the count reaches `at_cycles`; replaces a waiting alarm. */
void timer_alarm_at(uint32_t at_cycles);

void timer_cancel(void);

/** Acknowledge the interrupt. */
void timer_acknowledge(void);

#endif
