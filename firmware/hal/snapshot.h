/* SPDX-License-Identifier: BSD-2-Clause */
/** Positions of all axes at one instant, and that instant, latched by hardware. */
#ifndef HAL_SNAPSHOT_H
#define HAL_SNAPSHOT_H

#include <stdint.h>

enum { SNAPSHOT_AXES = 4 };

struct snapshot {
    int32_t position_counts[SNAPSHOT_AXES];
    uint64_t time_fast; /* clocks of 5 ns since reset */
};

/** What the last servo tick latched. Consistent when called before the next tick. */
void snapshot_tick_positions(int32_t position_counts[SNAPSHOT_AXES]);
uint64_t snapshot_tick_time_fast(void);

/** Latch now. Takes about a microsecond: waits until the values have crossed. Main loop only. */
void snapshot_now(struct snapshot *snapshot);

#endif
