/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/snapshot.h"

#include "regs.h"

void snapshot_tick_positions(int32_t position_counts[SNAPSHOT_AXES])
{
    for (unsigned axis = 0; axis < SNAPSHOT_AXES; axis++)
        position_counts[axis] = snapshot_tick_position_read(axis);
}

uint64_t snapshot_tick_time_fast(void)
{
    uint64_t time_fast = snapshot_tick_time_low_read();

    return time_fast | (uint64_t)snapshot_tick_time_high_read() << 32;
}

void snapshot_now(struct snapshot *snapshot)
{
    /* The crossing takes some ten clocks; the bound only guards against a gateware without it. */
    unsigned patience = 1000;

    snapshot_control_write(REG_SNAPSHOT_CONTROL_SAMPLE_MASK);
    while (snapshot_status_read() != 0 && patience > 0)
        patience--;
    for (unsigned axis = 0; axis < SNAPSHOT_AXES; axis++)
        snapshot->position_counts[axis] = snapshot_sample_position_read(axis);
    snapshot->time_fast = snapshot_sample_time_low_read();
    snapshot->time_fast |= (uint64_t)snapshot_sample_time_high_read() << 32;
}
