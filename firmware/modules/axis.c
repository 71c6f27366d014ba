/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/axis.h"

#include <stdatomic.h>
#include <stddef.h>
#include <string.h>

#include "core/events.h"
#include "core/fault.h"
#include "hal/inputs.h"
#include "hal/interrupts.h"
#include "hal/pwm.h"
#include "hal/snapshot.h"

_Static_assert(AXIS_TICK_PWM_PERIODS * PWM_PERIOD_US == AXIS_TICK_US, "tick period");

/* A plan for the interrupt to begin. Written by the main loop while `state` is not PENDING; the
 * interrupt only moves `state` on from there. */
struct handover {
    volatile enum axis_handover state;
    uint64_t tick;
    struct profile_point start;
    const struct profile_plan *plan;
    bool commanded;
};

/* What each tick touches stands together: the data cache is small. */
struct axis {
    /* The main loop's. */
    const struct loop_config *volatile config;
    volatile bool enabled;
    volatile uint32_t enables, disables; /* times it was switched on and off */
    struct handover handover;

    /* The interrupt's. */
    uint32_t enables_seen, disables_seen;
    const struct loop_config *config_seen;
    bool off; /* must not or cannot be driven */
    bool fault;
    bool limit_lower, limit_upper;
    bool limit_at_start;
    struct profile_state profile;
    struct loop_state loop;
    uint64_t begin_tick; /* of the plan in progress */
    struct axis_report report;
};

/* What the main loop prepares for an axis, in pairs: one in use, one spare. */
struct preparation {
    struct profile_plan plans[2];
    struct profile_plan *spare;
    struct loop_config configs[2];
};

static struct axis axes[AXIS_COUNT];
static struct preparation preparations[AXIS_COUNT];

/* Written by the interrupt. The main loop reads `ticks` before and after what is of one tick. */
static volatile uint64_t ticks;
static volatile uint64_t time_fast;
static volatile uint32_t cycles_last, cycles_max;

/* From here to axis_tick: in the tick interrupt. */

static void stop(struct axis *a, enum axis_stop why)
{
    loop_free(&a->loop, LOOP_NO_FAULT);
    a->report.stops++;
    a->report.last_stop = why;
    a->report.stop_at_start = a->limit_at_start;
}

static void take_handover(struct axis *a)
{
    struct handover *h = &a->handover;

    if (h->state != AXIS_HANDOVER_PENDING || ticks < h->tick || a->loop.mode == LOOP_FREE)
        return;
    if (h->start.position_q32 != a->profile.now.position_q32 ||
        h->start.velocity_q32 != a->profile.now.velocity_q32) {
        h->state = AXIS_HANDOVER_LATE;
        return;
    }
    profile_begin(&a->profile, h->plan);
    a->loop.commanded = h->commanded;
    a->begin_tick = ticks;
    a->limit_at_start = a->limit_lower || a->limit_upper;
    h->state = AXIS_HANDOVER_NONE;
}

/* Let go of an axis that must not be driven; take it back when it may and stands still. */
static void supervise(struct axis *a, bool inhibited)
{
    if (a->enables_seen != a->enables) {
        a->enables_seen = a->enables;
        a->fault = false;
    }
    /* Switched off counts also when it is on again already. */
    a->off = inhibited || !a->enabled || a->fault || a->disables_seen != a->disables;
    a->disables_seen = a->disables;
    if (a->loop.mode != LOOP_FREE) {
        if (a->off)
            stop(a, AXIS_STOP_INHIBITED);
    } else if (!a->off && a->loop.still_ticks >= AXIS_REST_TICKS) {
        loop_rest(&a->loop);
    }
}

/* A set-point must not lead into a closed switch. */
static void check_limits(struct axis *a)
{
    if (a->loop.mode == LOOP_FREE)
        return;
    if (a->profile.now.velocity_q32 > 0 && a->limit_upper)
        stop(a, AXIS_STOP_LIMIT_UPPER);
    else if (a->profile.now.velocity_q32 < 0 && a->limit_lower)
        stop(a, AXIS_STOP_LIMIT_LOWER);
}

static void note_fault(struct axis *a, enum loop_fault fault)
{
    static const enum axis_stop stops[] = {
        [LOOP_NOT_SETTLED] = AXIS_STOP_NOT_SETTLED,
        [LOOP_DEAD] = AXIS_STOP_DEAD,
        [LOOP_RUNAWAY] = AXIS_STOP_RUNAWAY,
    };

    a->report.stops++;
    a->report.last_stop = stops[fault];
    a->fault = fault != LOOP_NOT_SETTLED;
}

/* At rest, not moved since, and nothing asked for: this tick would change nothing. */
static bool rests(const struct axis *a, int32_t position_counts, bool inhibited)
{
    return a->loop.mode == LOOP_IDLE && a->loop.still_ticks > LOOP_LEAD_TICKS &&
           position_counts == a->loop.position_counts && a->profile.plan == NULL &&
           a->handover.state == AXIS_HANDOVER_NONE && a->enabled &&
           a->disables == a->disables_seen && !inhibited && a->config == a->config_seen;
}

static int32_t step(struct axis *a, int32_t position_counts, bool inhibited)
{
    bool regulated, commanded, behind;
    int32_t duty;

    if (rests(a, position_counts, inhibited))
        return 0;
    supervise(a, inhibited);
    profile_tick(&a->profile);
    take_handover(a);
    check_limits(a);

    /* An axis that is let go has its set-point where it is. */
    if (a->loop.mode == LOOP_FREE)
        profile_rest(&a->profile, (int64_t)position_counts * (INT64_C(1) << 32));

    regulated = a->loop.mode != LOOP_FREE;
    commanded = a->loop.commanded;
    behind = a->loop.behind;
    a->config_seen = a->config;
    duty = loop_tick(a->config_seen, &a->loop, &a->profile, position_counts);
    if (a->loop.behind && !behind)
        a->report.lags++;
    if (regulated && a->loop.mode == LOOP_FREE)
        note_fault(a, a->loop.fault);
    else if (commanded && a->loop.mode == LOOP_IDLE) {
        a->report.arrivals++;
        a->report.arrival_time_fast = time_fast;
    }
    if ((duty > 0 && a->limit_upper) || (duty < 0 && a->limit_lower))
        duty = 0;
    return duty;
}

bool axis_sample(unsigned axis, struct axis_sample *sample)
{
    const struct axis *a = &axes[axis];

    if (a->profile.plan == NULL && !a->loop.commanded)
        return false;
    sample->target_counts = (int32_t)(a->profile.now.position_q32 >> 32);
    sample->position_counts = a->loop.position_counts;
    sample->duty_steps = a->loop.duty_steps;
    return true;
}

void axis_tick(void)
{
    uint32_t began = interrupts_cycles();
    struct snapshot snapshot;
    struct inputs inputs;
    uint32_t took;

    snapshot_tick(&snapshot);
    inputs_read(&inputs);
    time_fast = snapshot.time_fast;
    ticks = ticks + 1;
    for (unsigned i = 0; i < AXIS_COUNT; i++) {
        struct axis *a = &axes[i];

        a->limit_lower = (inputs.limit_lower >> i & 1u) != 0;
        a->limit_upper = (inputs.limit_upper >> i & 1u) != 0;
        pwm_set_steps(i, step(a, snapshot.position_counts[i], inputs.estop));
    }
    if (pwm_acknowledge_tick())
        log_error_from_interrupt(FAULT_TASK_OVERTIME);
    events_publish_from_interrupt(EVENT_SERVO_TICK, (uint32_t)ticks, snapshot.time_fast);

    took = interrupts_cycles() - began;
    cycles_last = took;
    if (took > cycles_max)
        cycles_max = took;
}

/* From here on: in the main loop. */

void axis_init(void)
{
    struct snapshot snapshot;

    snapshot_now(&snapshot);
    ticks = 0;
    time_fast = snapshot.time_fast;
    cycles_last = 0;
    cycles_max = 0;
    memset(axes, 0, sizeof axes);
    memset(preparations, 0, sizeof preparations);
    for (unsigned i = 0; i < AXIS_COUNT; i++) {
        struct axis *a = &axes[i];

        a->config = &preparations[i].configs[0];
        a->loop.position_counts = snapshot.position_counts[i];
        profile_rest(&a->profile, (int64_t)snapshot.position_counts[i] * (INT64_C(1) << 32));
        loop_free(&a->loop, LOOP_NO_FAULT);
        pwm_set_steps(i, 0);
    }
    pwm_enable((1u << AXIS_COUNT) - 1u);
    pwm_set_tick_periods(AXIS_TICK_PWM_PERIODS);
}

uint64_t axis_ticks(void)
{
    uint64_t now;

    do
        now = ticks;
    while (now != ticks);
    return now;
}

uint64_t axis_time_fast(void)
{
    uint64_t now;

    do
        now = time_fast;
    while (now != time_fast);
    return now;
}

uint32_t axis_tick_cycles(void)
{
    return cycles_last;
}

uint32_t axis_tick_cycles_max(void)
{
    return cycles_max;
}

/* Copy what the interrupt owns, again until no tick came in between. */
static void copy(const struct axis *a, struct axis_view *view, uint64_t *begin_tick,
                 const struct profile_plan **plan)
{
    do {
        const struct profile_plan *running;

        view->tick = axis_ticks();
        atomic_signal_fence(memory_order_seq_cst);
        running = a->profile.plan;
        *plan = running;
        *begin_tick = a->begin_tick;
        view->setpoint = a->profile.now;
        view->planned = running != NULL;
        view->end_q32 = view->planned ? running->end_q32 : view->setpoint.position_q32;
        view->ramping = a->profile.half_acceleration_q32 != 0;
        view->ramping_up =
            (a->profile.half_acceleration_q32 > 0) == (view->setpoint.velocity_q32 > 0);
        view->mode = a->loop.mode;
        view->commanded = a->loop.commanded;
        view->position_counts = a->loop.position_counts;
        view->error_counts = a->loop.error_counts;
        view->duty_steps = a->loop.duty_steps;
        view->limit_lower = a->limit_lower;
        view->limit_upper = a->limit_upper;
        view->off = a->off;
        view->report = a->report;
        atomic_signal_fence(memory_order_seq_cst);
    } while (view->tick != axis_ticks());
}

void axis_read(unsigned axis, struct axis_view *view)
{
    uint64_t begin_tick;
    const struct profile_plan *plan;

    copy(&axes[axis], view, &begin_tick, &plan);
}

struct profile_point axis_predict(unsigned axis, uint64_t tick)
{
    struct axis_view view;
    uint64_t begin_tick;
    const struct profile_plan *plan;

    copy(&axes[axis], &view, &begin_tick, &plan);
    return plan != NULL ? profile_at(plan, tick - begin_tick) : view.setpoint;
}

void axis_configure(unsigned axis, const struct loop_config *config)
{
    struct axis *a = &axes[axis];
    struct loop_config *configs = preparations[axis].configs;
    struct loop_config *spare = a->config == &configs[0] ? &configs[1] : &configs[0];

    *spare = *config;
    atomic_signal_fence(memory_order_release);
    a->config = spare;
}

void axis_enable(unsigned axis, bool enable)
{
    if (enable)
        axes[axis].enables = axes[axis].enables + 1;
    else
        axes[axis].disables = axes[axis].disables + 1;
    axes[axis].enabled = enable;
}

bool axis_enabled(unsigned axis)
{
    const struct axis *a = &axes[axis];

    return a->enabled && (!a->fault || a->enables_seen != a->enables);
}

bool axis_inhibited(void)
{
    struct inputs inputs;

    inputs_read(&inputs);
    return inputs.estop;
}

struct profile_plan *axis_plan(unsigned axis)
{
    struct axis *a = &axes[axis];
    struct preparation *p = &preparations[axis];

    /* From here on the plan in use does not change, but it may end: so remember the other one. */
    a->handover.state = AXIS_HANDOVER_NONE;
    atomic_signal_fence(memory_order_seq_cst);
    p->spare = a->profile.plan == &p->plans[0] ? &p->plans[1] : &p->plans[0];
    return p->spare;
}

void axis_hand_over(unsigned axis, const struct profile_point *start, uint64_t tick,
                    bool commanded)
{
    struct axis *a = &axes[axis];

    a->handover.plan = preparations[axis].spare;
    a->handover.start = *start;
    a->handover.tick = tick;
    a->handover.commanded = commanded;
    atomic_signal_fence(memory_order_release);
    a->handover.state = AXIS_HANDOVER_PENDING;
}

enum axis_handover axis_handover(unsigned axis)
{
    return axes[axis].handover.state;
}
