/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/watchdog.h"

#include "regs.h"

void watchdog_start(uint32_t timeout_ms)
{
    watchdog_timeout_write(timeout_ms * (CLOCK_HZ / 1000u));
    watchdog_kick();
    watchdog_control_write(REG_WATCHDOG_CONTROL_ENABLE_MASK);
}

void watchdog_kick(void)
{
    watchdog_kick_write(WATCHDOG_KICK_WORD);
}

enum watchdog_cause watchdog_cause(void)
{
    return (enum watchdog_cause)watchdog_status_cause_get();
}

bool watchdog_cold(void)
{
    return watchdog_status_cold_get() != 0;
}

void watchdog_set_warm(void)
{
    watchdog_status_write(REG_WATCHDOG_STATUS_COLD_MASK);
}

void watchdog_reset_processor(void)
{
    watchdog_reset_write(WATCHDOG_RESET_WORD);
}

uint32_t watchdog_scratch(void)
{
    return watchdog_scratch_read();
}

void watchdog_set_scratch(uint32_t word)
{
    watchdog_scratch_write(word);
}
