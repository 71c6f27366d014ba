/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/settling.h"

#include <string.h>

#include "core/events.h"
#include "modules/axis.h"

static struct watch {
    struct settling result;
    bool settling;
    uint64_t tick;
    uint64_t since_fast;
    uint32_t arrivals;
    uint32_t count;
} watches[AXIS_COUNT];

const struct settling *settling_of(unsigned axis)
{
    return &watches[axis].result;
}

void settling_init(void)
{
    memset(watches, 0, sizeof watches);
}

static void note_arrival(struct watch *w, const struct axis_report *report)
{
    w->arrivals = report->arrivals;
    if (!w->settling || report->arrival_time_fast < w->since_fast)
        return;
    w->count++;
    w->result.last_ms = (double)(report->arrival_time_fast - w->since_fast) / EVENTS_FAST_PER_MS;
    w->result.mean_ms += (w->result.last_ms - w->result.mean_ms) / w->count;
}

static void follow(struct watch *w, const struct axis_view *view)
{
    if (view->tick == w->tick)
        return;
    w->tick = view->tick;
    if (view->report.arrivals != w->arrivals)
        note_arrival(w, &view->report);
    if (view->planned)
        w->result.error_sum_counts = 0;
    if (!w->settling)
        w->since_fast = axis_time_fast();
    w->settling = view->commanded && !view->planned;
    if (w->settling)
        w->result.error_sum_counts += view->error_counts;
}

void settling_poll(void)
{
    static unsigned axis;
    struct axis_view view;

    axis = (axis + 1) % AXIS_COUNT;
    axis_read(axis, &view);
    follow(&watches[axis], &view);
}
