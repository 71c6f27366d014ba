/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/origin_history.h"

#include <stdatomic.h>

#include "core/axis.h"
#include "hal/snapshot.h"
#include "modules/coordinates.h"

/* One more than is read, for the one being written. */
enum { ENTRIES = ORIGIN_CHANGES + 1 };
_Static_assert((ENTRIES & (ENTRIES - 1)) == 0, "the index wraps");

static struct entry {
    uint64_t from_fast;
    int32_t origin_counts[AXIS_COUNT];
} entries[ENTRIES];
static _Atomic unsigned newest;

static int32_t origin(unsigned axis)
{
    return coordinates_user_to_counts(axis, 0);
}

void origin_history_start(void)
{
    for (unsigned n = 0; n < ENTRIES; n++) {
        entries[n].from_fast = 0;
        for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
            entries[n].origin_counts[axis] = origin(axis);
    }
}

void origin_history_note(unsigned axis)
{
    const unsigned before = atomic_load_explicit(&newest, memory_order_relaxed);
    struct entry *entry = &entries[(before + 1) % ENTRIES];
    struct snapshot now;

    snapshot_now(&now);
    *entry = entries[before % ENTRIES];
    entry->from_fast = now.time_fast;
    entry->origin_counts[axis] = origin(axis);
    atomic_signal_fence(memory_order_release);
    atomic_store_explicit(&newest, before + 1, memory_order_relaxed);
}

const int32_t *origin_history_at(uint64_t time_fast)
{
    unsigned n = atomic_load_explicit(&newest, memory_order_relaxed);

    for (unsigned older = 1; older < ORIGIN_CHANGES; older++, n--)
        if (entries[n % ENTRIES].from_fast <= time_fast)
            break;
    return entries[n % ENTRIES].origin_counts;
}
