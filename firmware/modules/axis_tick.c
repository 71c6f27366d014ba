/* SPDX-License-Identifier: BSD-2-Clause */
/* The tick interrupt: what every tick does for all axes. Built for speed. */
#include "modules/axis_state.h"

#include <stddef.h>

#include "core/events.h"
#include "core/fault.h"
#include "hal/interlock.h"
#include "hal/interrupts.h"
#include "hal/pwm.h"
#include "hal/snapshot.h"

_Static_assert(AXIS_TICK_PWM_PERIODS * PWM_PERIOD_US == AXIS_TICK_US, "tick period");
_Static_assert(LOOP_TURN_TICKS > AXIS_COUNT, "one tick for each axis, one for the event");

struct axis axis_states[AXIS_COUNT];
volatile uint32_t axis_tick_count, axis_tick_count_high;
volatile uint32_t axis_cycles_last, axis_cycles_max;
volatile bool axis_trigger_watched;
void (*volatile axis_source)(void);

/* True: a plan began, which takes about as long as a turn. */
static inline bool begins(struct axis *a)
{
    if (SELDOM(a->handover.state == AXIS_HANDOVER_PENDING &&
               (int32_t)(axis_tick_count - a->handover.tick) >= 0))
        return axis_begin(a);
    return false;
}

void axis_tick(void)
{
    static unsigned turn; /* which axis is next; AXIS_COUNT: the event */
    uint32_t began = interrupts_cycles();
    struct axis *a = axis_states;
    int32_t positions[SNAPSHOT_AXES], duties[SNAPSHOT_AXES] = {0}, expected[SNAPSHOT_AXES] = {0};
    uint32_t now = axis_tick_count + 1, took;
    bool busy = false;

    snapshot_tick_positions(positions);
    axis_tick_count = now;
    if (now == 0)
        axis_tick_count_high = axis_tick_count_high + 1;
    if (SELDOM(axis_trigger_watched))
        axis_trigger();
    if (SELDOM(axis_source != NULL))
        axis_source();
    for (unsigned i = 0; i < AXIS_COUNT; i++, a++) {
        busy |= profile_tick(&a->profile);
        busy |= begins(a);
        duties[i] = loop_tick(&a->loop, &a->profile, positions[i]);
        expected[i] = (int32_t)(a->profile.position_q32 >> 32);
    }
    pwm_set_steps(duties);
    interlock_expect(expected);
    /* A tick that had more to do leaves the turn to the next. */
    if (!SELDOM(busy)) {
        if (turn < AXIS_COUNT)
            axis_turn(&axis_states[turn], turn, positions[turn], duties[turn]);
        else if (turn == AXIS_COUNT && events_heard(EVENT_SERVO_TURN))
            events_publish_from_interrupt(EVENT_SERVO_TURN, now, snapshot_tick_time_fast());
        turn = turn + 1 < LOOP_TURN_TICKS ? turn + 1 : 0;
    }
    /* The first one comes after a start-up that took longer than a tick. */
    if (pwm_acknowledge_tick() && now != 1)
        log_error_from_interrupt(FAULT_TASK_OVERTIME);
    took = interrupts_cycles() - began;
    axis_cycles_last = took;
    if (took > axis_cycles_max)
        axis_cycles_max = took;
}
