/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/compare.h"

#include "regs.h"

void compare_arm(unsigned axis, int32_t reference_edge, bool reverse)
{
    compare_config_write((axis << REG_COMPARE_CONFIG_AXIS_SHIFT) |
                         (reverse ? REG_COMPARE_CONFIG_REVERSE_MASK : 0));
    compare_reference_write(reference_edge);
    compare_control_write(REG_COMPARE_CONTROL_ARM_MASK);
}

void compare_disarm(void)
{
    compare_control_write(REG_COMPARE_CONTROL_DISARM_MASK);
}

struct compare_status compare_status(void)
{
    /* The crossing takes some ten clocks; the bound only guards against a gateware without it. */
    unsigned patience = 1000;
    uint32_t status = compare_status_read();

    while ((status & REG_COMPARE_STATUS_BUSY_MASK) != 0 && patience > 0) {
        status = compare_status_read();
        patience--;
    }
    return (struct compare_status){
        .armed = (status & REG_COMPARE_STATUS_ARMED_MASK) != 0,
        .active = (status & REG_COMPARE_STATUS_ACTIVE_MASK) != 0,
        .late = (status & REG_COMPARE_STATUS_LATE_MASK) != 0,
    };
}

struct compare_events compare_take_events(void)
{
    uint32_t events = compare_interrupt_read();

    compare_interrupt_write(events);
    return (struct compare_events){
        .started = (events & REG_COMPARE_INTERRUPT_STARTED_MASK) != 0,
        .finished = (events & REG_COMPARE_INTERRUPT_FINISHED_MASK) != 0,
        .late = (events & REG_COMPARE_INTERRUPT_LATE_MASK) != 0,
    };
}
