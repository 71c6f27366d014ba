/* SPDX-License-Identifier: BSD-2-Clause */
/* What the interrupt has to report of an axis: arrivals, stops, and a motor that cannot follow. */
#include "modules/motion_state.h"

#include "core/events.h"
#include "core/fault.h"
#include "modules/limits.h"

static enum motion_end why(enum axis_stop stop)
{
    switch (stop) {
    case AXIS_STOP_LIMIT_LOWER:
    case AXIS_STOP_LIMIT_UPPER:
        return MOTION_LIMIT;
    case AXIS_STOP_INHIBITED:
        return MOTION_DISABLED;
    default:
        return MOTION_FAULT;
    }
}

static uint16_t code(unsigned axis, const struct axis_report *report)
{
    enum fault limit;

    switch (report->last_stop) {
    case AXIS_STOP_LIMIT_LOWER:
    case AXIS_STOP_LIMIT_UPPER:
        limit = limits_fault(axis, report->last_stop == AXIS_STOP_LIMIT_UPPER);
        return (uint16_t)(limit + (report->stop_at_start ? FAULT_INTO : 0));
    case AXIS_STOP_NOT_SETTLED:
        return (uint16_t)(FAULT_ADJUST_MOVE + axis);
    case AXIS_STOP_DEAD:
        return (uint16_t)(FAULT_AXIS_DEAD + axis);
    case AXIS_STOP_RUNAWAY:
        return (uint16_t)(FAULT_RUNAWAY + axis);
    case AXIS_STOP_OVERFLOW:
        return (uint16_t)(FAULT_ENCODER_OVERFLOW + axis);
    default:
        return FAULT_NONE;
    }
}

void motion_report(unsigned axis)
{
    struct motion *m = &motions[axis];
    uint32_t news = axis_news(axis);
    struct axis_view view;

    if (news == m->news_seen && !m->waiting && !motion_is_under_way(m) &&
        !motion_handed_over(axis))
        return;
    m->news_seen = news;
    axis_read(axis, &view);
    if (view.off && (m->waiting || motion_handed_over(axis))) {
        m->waiting = false;
        motion_forget_legs(m);
        (void)axis_plan(axis);
        motion_tell(axis, MOTION_DISABLED);
    }
    if (motion_is_under_way(m) && !m->waiting && !view.planned &&
        !motion_handed_over(axis)) {
        m->leg++;
        m->waiting = true;
    }
    if (view.report.lags != m->lags_seen) {
        m->lags_seen = view.report.lags;
        log_error((uint16_t)(FAULT_ERROR_LARGE + axis));
    }
    if (view.report.stops != m->stops_seen) {
        m->stops_seen = view.report.stops;
        m->waiting = m->waiting && !motion_is_under_way(m);
        motion_forget_legs(m);
        if (code(axis, &view.report) != FAULT_NONE)
            log_error(code(axis, &view.report));
        motion_tell(axis, why(view.report.last_stop));
    }
    if (view.report.arrivals != m->arrivals_seen) {
        m->arrivals_seen = view.report.arrivals;
        if (!m->stopping)
            events_publish(EVENT_MOVE_DONE, axis, view.report.arrival_time_fast);
    }
}
