/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/axis_state.h"

#include <stdatomic.h>
#include <stddef.h>
#include <string.h>

#include "hal/inputs.h"
#include "hal/interlock.h"
#include "hal/pwm.h"
#include "hal/snapshot.h"

/* What the main loop prepares for an axis, in pairs: one in use, one spare. */
struct preparation {
    struct loop_config configs[2];
    struct profile_plan plans[2];
    struct profile_plan *spare;
};

static struct preparation preparations[AXIS_COUNT];

uint64_t axis_ticks(void)
{
    uint32_t low, high;

    do {
        high = axis_tick_count_high;
        low = axis_tick_count;
    } while (high != axis_tick_count_high);
    return (uint64_t)high << 32 | low;
}

void axis_init(void)
{
    static const int32_t off[SNAPSHOT_AXES];
    struct snapshot snapshot;

    snapshot_now(&snapshot);
    axis_tick_count = 0;
    axis_tick_count_high = 0;
    axis_cycles_last = 0;
    axis_cycles_max = 0;
    axis_trigger_watch(false);
    axis_set_source(NULL);
    memset(axis_states, 0, sizeof axis_states);
    memset(preparations, 0, sizeof preparations);
    for (unsigned i = 0; i < AXIS_COUNT; i++) {
        struct axis *a = &axis_states[i];

        a->config = &preparations[i].configs[0];
        a->configures = 1;
        a->loop.position_counts = snapshot.position_counts[i];
        profile_rest(&a->profile, (int64_t)snapshot.position_counts[i] * (INT64_C(1) << 32));
        loop_free(&a->loop, LOOP_NO_FAULT);
    }
    pwm_set_steps(off);
    interlock_watch(0, 0);
    pwm_enable((1u << AXIS_COUNT) - 1u);
    pwm_set_tick_periods(AXIS_TICK_PWM_PERIODS);
}

uint64_t axis_time_fast(void)
{
    uint64_t time_fast;
    uint32_t tick;

    do {
        tick = axis_tick_count;
        time_fast = snapshot_tick_time_fast();
    } while (tick != axis_tick_count);
    return time_fast;
}

uint32_t axis_tick_cycles(void)
{
    return axis_cycles_last;
}

uint32_t axis_tick_cycles_max(void)
{
    return axis_cycles_max;
}

bool axis_commanded(unsigned axis)
{
    return *(volatile const bool *)&axis_states[axis].loop.commanded;
}

int32_t axis_position_counts(unsigned axis)
{
    return *(volatile const int32_t *)&axis_states[axis].loop.position_counts;
}

uint32_t axis_news(unsigned axis)
{
    const volatile struct axis_report *report = &axis_states[axis].report;

    return report->arrivals + report->lags + report->stops;
}

void axis_read(unsigned axis, struct axis_view *view)
{
    const struct axis *a = &axis_states[axis];
    struct profile_state profile;

    /* Copy what the interrupt owns, again until no tick came in between. */
    do {
        view->tick = axis_tick_count;
        atomic_signal_fence(memory_order_seq_cst);
        profile = a->profile;
        view->generation = a->generation;
        view->begin_tick = a->begin_tick;
        view->mode = (enum loop_mode)a->loop.mode;
        view->commanded = a->loop.commanded;
        view->position_counts = a->loop.position_counts;
        view->error_counts = a->loop.error_counts;
        view->duty_steps = a->loop.duty_steps;
        view->limit_lower = a->limit_lower;
        view->limit_upper = a->limit_upper;
        /* Switches count at once; the axis takes them at its next turn. */
        view->off = (a->off && a->enables_seen == a->enables) || !a->enabled ||
                    a->disables_seen != a->disables;
        view->report = a->report;
        atomic_signal_fence(memory_order_seq_cst);
    } while (view->tick != axis_tick_count);
    view->setpoint = profile_now(&profile);
    view->plan = profile.plan;
    view->planned = profile.plan != NULL;
    view->end_q32 = view->planned ? profile.plan->end_q32 : profile.position_q32;
    view->ramping = profile.change_q48 != 0;
    view->ramping_up = (profile.change_q48 > 0) == (profile.step_q48 > 0);
}

bool axis_sample(unsigned axis, struct axis_sample *sample)
{
    const struct axis *a = &axis_states[axis];

    sample->target_counts = (int32_t)(a->profile.position_q32 >> 32);
    sample->position_counts = a->loop.position_counts;
    sample->duty_steps = a->loop.duty_steps;
    return a->profile.plan != NULL || a->loop.commanded;
}

struct profile_point axis_predict(unsigned axis, uint64_t tick, uint32_t *generation)
{
    struct axis_view view;

    axis_read(axis, &view);
    *generation = view.generation;
    return view.planned ? profile_at(view.plan, tick - view.begin_tick) : view.setpoint;
}

void axis_spin(unsigned axis, int32_t duty_steps)
{
    axis_states[axis].spin_steps = duty_steps;
    atomic_signal_fence(memory_order_release);
    axis_states[axis].spins = axis_states[axis].spins + 1;
}

void axis_configure(unsigned axis, const struct loop_config *config)
{
    struct axis *a = &axis_states[axis];
    struct loop_config *configs = preparations[axis].configs;
    struct loop_config *spare = a->config == &configs[0] ? &configs[1] : &configs[0];

    *spare = *config;
    atomic_signal_fence(memory_order_release);
    a->config = spare;
    a->configures = a->configures + 1;
}

void axis_enable(unsigned axis, bool enable)
{
    if (enable)
        axis_states[axis].enables = axis_states[axis].enables + 1;
    else
        axis_states[axis].disables = axis_states[axis].disables + 1;
    axis_states[axis].enabled = enable;
}

bool axis_enabled(unsigned axis)
{
    const struct axis *a = &axis_states[axis];

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
    struct axis *a = &axis_states[axis];
    struct preparation *p = &preparations[axis];

    /* From here on the plan in use does not change, but it may end: so remember the other one. */
    a->handover.state = AXIS_HANDOVER_NONE;
    atomic_signal_fence(memory_order_seq_cst);
    p->spare = a->profile.plan == &p->plans[0] ? &p->plans[1] : &p->plans[0];
    return p->spare;
}

void axis_hand_over(unsigned axis, uint32_t generation, uint64_t tick, bool commanded)
{
    struct axis *a = &axis_states[axis];

    a->handover.plan = preparations[axis].spare;
    a->handover.generation = generation;
    a->handover.tick = (uint32_t)tick;
    a->handover.triggered = false;
    a->handover.commanded = commanded;
    atomic_signal_fence(memory_order_release);
    a->handover.state = AXIS_HANDOVER_PENDING;
}

enum axis_handover axis_handover(unsigned axis)
{
    return axis_states[axis].handover.state;
}

void axis_arm(unsigned axis, uint32_t generation, bool commanded)
{
    struct axis *a = &axis_states[axis];

    a->handover.plan = preparations[axis].spare;
    a->handover.generation = generation;
    a->handover.commanded = commanded;
    atomic_signal_fence(memory_order_release);
    a->handover.state = AXIS_HANDOVER_ARMED;
}

void axis_trigger_watch(bool watch)
{
    axis_trigger_fired = false;
    axis_trigger_held = false;
    axis_trigger_watched = watch;
    atomic_signal_fence(memory_order_seq_cst);
}

void axis_trigger_hold(void)
{
    axis_trigger_held = true;
}

void axis_trigger_notice(void)
{
    if (axis_trigger_watched && !axis_trigger_held)
        axis_trigger_fired = true;
}

void axis_trigger_fire(void)
{
    axis_trigger_fired = true;
}

uint32_t axis_triggers(void)
{
    return axis_trigger_count;
}

void axis_set_source(void (*source)(void))
{
    atomic_signal_fence(memory_order_seq_cst);
    axis_source = source;
    atomic_signal_fence(memory_order_seq_cst);
}

uint32_t axis_generation(unsigned axis)
{
    return *(volatile const uint32_t *)&axis_states[axis].generation;
}
