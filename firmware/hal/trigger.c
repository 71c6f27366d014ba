/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/trigger.h"

#include "regs.h"

/* Reads of a register that take as long as the longest pulse and its record's way: 1.7 us. */
enum { PULSE_READS = 24 };

void trigger_enable(enum trigger_source source, bool falling, unsigned minimum_fast)
{
    trigger_config_write(REG_TRIGGER_CONFIG_ENABLE_MASK |
                         (source == TRIGGER_OUT0 ? REG_TRIGGER_CONFIG_OUTPUT_MASK : 0) |
                         (falling ? REG_TRIGGER_CONFIG_FALLING_MASK : 0) |
                         minimum_fast << REG_TRIGGER_CONFIG_MINIMUM_SHIFT);
}

void trigger_disable(void)
{
    trigger_config_write(trigger_config_read() & ~REG_TRIGGER_CONFIG_ENABLE_MASK);
    for (unsigned n = 0; n < PULSE_READS; n++)
        (void)trigger_level_read();
}

bool trigger_take(struct trigger_record *record)
{
    if (trigger_level_read() == 0)
        return false;
    record->time_fast = trigger_time_low_read();
    record->time_fast |= (uint64_t)trigger_time_high_read() << 32;
    record->position_counts[0] = trigger_count0_read();
    record->position_counts[1] = trigger_count1_read();
    record->position_counts[2] = trigger_count2_read();
    record->position_counts[3] = trigger_count3_read();
    trigger_next_write(REG_TRIGGER_NEXT_TAKE_MASK);
    return true;
}

void trigger_clear(void)
{
    for (uint32_t waiting = trigger_level_read(); waiting > 0; waiting--)
        trigger_next_write(REG_TRIGGER_NEXT_TAKE_MASK);
}

uint32_t trigger_missed(void)
{
    return trigger_missed_read();
}

void trigger_interrupt(bool enable)
{
    trigger_interrupt_enable_write(enable ? REG_TRIGGER_INTERRUPT_ENABLE_WAITING_MASK : 0);
}
