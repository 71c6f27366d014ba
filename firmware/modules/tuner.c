/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * One axis after the other:
 *
 *     REST    at rest, regulated; a wait for it after power-up, RESET and MC +
 *     STRONG  open loop, a strong drive, until the speed is steady
 *     WEAK    a weaker one, until it is steady
 *     REST, STRONG, WEAK  the other way
 *     REST    the gains are set
 *     RETURN  a closed-loop move to where it began, with them: the proof
 *
 * Whatever goes wrong on the way, or HALT, ends it with the gains as they were.
 */
#include "modules/tuner.h"

#include <stdatomic.h>
#include <stddef.h>

#include "core/events.h"
#include "core/fault.h"
#include "hal/pwm.h"
#include "modules/axis.h"
#include "modules/interlock.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "modules/tuning.h"
#include "servo/identify.h"

#define STRONG_STEPS (PWM_FULL_STEPS * 3 / 4)
#define WEAK_STEPS (PWM_FULL_STEPS * 2 / 5)

/* Of a turn that sees the first drive: the turn before it changed the drive, which the next tick
 * computed and the one after it drove. */
#define FIRST_MS ((LOOP_TURN_TICKS - 2) * AXIS_TICK_US / 1000.0)

/* A run takes about 120 ms, and no drive goes faster than the axis' fastest. */
#define ROOM_S 0.15

/* Of the whole of an axis, and the speed and the ramp of the way back. */
#define PATIENCE_FAST (3 * EVENTS_FAST_PER_S)
#define RETURN_SHARE 0.5
#define RETURN_RAMP_MS 50.0

enum phase { PHASE_NONE, PHASE_REST, PHASE_STRONG, PHASE_WEAK, PHASE_RETURN };

static struct {
    enum phase phase;
    bool failed;
    unsigned axes; /* that are still to be done, the present one among them */
    unsigned axis;
    int direction; /* of the present run; the second goes against the first */
    unsigned runs; /* that are done */
    int32_t start_counts;
    uint64_t began_fast;
    bool changed; /* the axis has new gains; these are the old ones */
    struct pid_gains old_gains;
    struct identify_motor motors[2];
} tuner;

/* Written by the tick interrupt while `recording`, read by the main loop up to `turns`. */
static struct identify_run run;
static volatile bool recording;
static volatile unsigned strong_turns, turns;

/* --- In the tick interrupt ---------------------------------------------------------------------- */

static void record(const struct event *event)
{
    struct axis_sample now;

    (void)event;
    if (!recording || turns == IDENTIFY_TURNS)
        return;
    (void)axis_sample(tuner.axis, &now);
    if (now.duty_steps == run.strong_steps)
        strong_turns = turns + 1;
    else if (now.duty_steps != run.weak_steps || strong_turns == 0)
        return;
    run.position_counts[turns] = now.position_counts;
    atomic_signal_fence(memory_order_release);
    turns = turns + 1;
}

/* --- The end ------------------------------------------------------------------------------------ */

static void ended(unsigned axis, enum motion_end why);
static bool yield(unsigned axis, const struct motion_owner *to);

static const struct motion_owner owner = {
    .name = "tuner", .busy = true, .holds = true, .letter = 'B', .ended = ended, .yield = yield,
};

static void finish(bool failed)
{
    recording = false;
    tuner.failed = failed;
    tuner.phase = PHASE_NONE;
    axis_spin(tuner.axis, 0);
    interlock_measure(tuner.axis, false);
    if (failed && tuner.changed)
        tuning_set_gains(tuner.axis, &tuner.old_gains);
    motion_release(tuner.axes, &owner);
    tuner.axes = 0;
}

static bool yield(unsigned axis, const struct motion_owner *to)
{
    (void)axis;
    (void)to;
    return false;
}

static void ended(unsigned axis, enum motion_end why)
{
    (void)axis;
    (void)why;
    if (tuner.phase != PHASE_NONE)
        finish(true);
}

/* --- The runs ----------------------------------------------------------------------------------- */

static bool is_at_rest(unsigned axis)
{
    struct axis_view view;

    axis_read(axis, &view);
    return view.mode == LOOP_IDLE && !view.planned && axis_handover(axis) == AXIS_HANDOVER_NONE;
}

/* Regulated at rest soon, if it is not yet. */
static bool comes_to_rest(unsigned axis)
{
    struct axis_view view;

    axis_read(axis, &view);
    return view.mode == LOOP_FREE || is_at_rest(axis);
}

/* The direction in which there is room for a run, or 0. */
static int find_room(unsigned axis)
{
    const int32_t way = (int32_t)tuning_counts_per_s(
        axis, ROOM_S * tuning_speed_max_mm_per_s(axis));
    struct axis_view view;

    axis_read(axis, &view);
    if (view.limit_upper || view.limit_lower || !limits_allow(axis, view.position_counts))
        return 0;
    if (limits_allow(axis, view.position_counts + way))
        return 1;
    return limits_allow(axis, view.position_counts - way) ? -1 : 0;
}

static void drive(int32_t steps)
{
    axis_spin(tuner.axis, tuner.direction * steps);
}

static void begin_run(void)
{
    if (tuner.runs == 0)
        tuner.start_counts = motion_target_counts(tuner.axis);
    run.strong_steps = tuner.direction * STRONG_STEPS;
    run.weak_steps = tuner.direction * WEAK_STEPS;
    strong_turns = 0;
    turns = 0;
    atomic_signal_fence(memory_order_release);
    recording = true;
    interlock_measure(tuner.axis, true);
    drive(STRONG_STEPS);
    tuner.phase = PHASE_STRONG;
}

/* An axis that does not go, or goes backward, is one for the log. */
static bool obeys(unsigned count)
{
    int32_t way;

    if (count < IDENTIFY_TURNS_DEAD)
        return true;
    way = tuner.direction * (run.position_counts[count - 1] - run.position_counts[0]);
    if (way > LOOP_DEAD_COUNTS)
        return true;
    log_error((uint16_t)((way < -LOOP_DEAD_COUNTS ? FAULT_RUNAWAY : FAULT_AXIS_DEAD) + tuner.axis));
    return false;
}

static bool is_outside(void)
{
    int32_t at = motion_position_counts(tuner.axis);

    return tuner.direction > 0 ? limits_at_upper(tuner.axis, at) : limits_at_lower(tuner.axis, at);
}

static void end_run(void)
{
    recording = false;
    axis_spin(tuner.axis, 0);
    interlock_measure(tuner.axis, false);
    run.turn_ms = AXIS_TURN_US / 1000.0;
    run.first_ms = FIRST_MS;
    run.strong_turns = strong_turns;
    run.turns = turns;
    if (!identify_motor(&run, &tuner.motors[tuner.runs])) {
        finish(true);
        return;
    }
    tuner.runs++;
    tuner.direction = -tuner.direction;
    tuner.phase = PHASE_REST;
}

static void follow_run(void)
{
    const unsigned strong = strong_turns, all = turns;

    if (!obeys(all) || is_outside() || all == IDENTIFY_TURNS) {
        finish(true);
    } else if (tuner.phase == PHASE_STRONG) {
        if (identify_is_steady(run.position_counts, all)) {
            drive(WEAK_STEPS);
            tuner.phase = PHASE_WEAK;
        }
    } else if (all > strong && identify_is_steady(run.position_counts + strong, all - strong)) {
        end_run();
    }
}

/* --- The gains, and their proof ----------------------------------------------------------------- */

static void go_back(void)
{
    struct motion_move move = {
        .axis = tuner.axis,
        .target_counts = tuner.start_counts,
        .speed_counts_per_s = tuning_counts_per_s(
            tuner.axis, RETURN_SHARE * tuning_speed_max_mm_per_s(tuner.axis)),
        .ramp_ms = RETURN_RAMP_MS,
    };
    struct pid_gains gains = tuning_gains(tuner.axis);
    struct identify_motor motor;

    if (!identify_mean(&tuner.motors[0], &tuner.motors[1], &motor) ||
        !identify_gains(&motor, &gains)) {
        finish(true);
        return;
    }
    tuner.old_gains = tuning_gains(tuner.axis);
    tuner.changed = true;
    tuning_set_gains(tuner.axis, &gains);
    motion_start(&move, 1);
    tuner.phase = PHASE_RETURN;
}

static bool has_arrived(void)
{
    struct axis_view view;

    axis_read(tuner.axis, &view);
    return (view.mode == LOOP_IDLE || view.mode == LOOP_WAIT || view.mode == LOOP_HOLD) &&
           !view.planned && axis_handover(tuner.axis) == AXIS_HANDOVER_NONE;
}

/* --- One axis after the other ------------------------------------------------------------------- */

/* The lowest axis that is left; the end when there is none. */
static void next_axis(void)
{
    if (tuner.axes == 0) {
        finish(false);
        return;
    }
    tuner.axis = 0;
    while ((tuner.axes & MOTION_AXIS(tuner.axis)) == 0)
        tuner.axis++;
    tuner.direction = find_room(tuner.axis);
    tuner.runs = 0;
    tuner.changed = false;
    tuner.began_fast = axis_time_fast();
    tuner.phase = PHASE_REST;
    if (tuner.direction == 0)
        finish(true);
}

static void end_axis(void)
{
    motion_release(MOTION_AXIS(tuner.axis), &owner);
    tuner.axes &= ~MOTION_AXIS(tuner.axis);
    next_axis();
}

static void poll(void)
{
    if (tuner.phase == PHASE_NONE)
        return;
    if (axis_time_fast() - tuner.began_fast > PATIENCE_FAST) {
        finish(true);
    } else if (tuner.phase == PHASE_REST) {
        if (!is_at_rest(tuner.axis))
            return;
        if (tuner.runs < 2)
            begin_run();
        else
            go_back();
    } else if (tuner.phase == PHASE_RETURN) {
        if (has_arrived())
            end_axis();
    } else {
        follow_run();
    }
}

/* --- The command -------------------------------------------------------------------------------- */

static enum status azero(const struct request *request, struct reply *reply)
{
    unsigned axes = 0;

    if (reply->step > 0) {
        if (tuner.phase != PHASE_NONE)
            return STATUS_PENDING;
        reply_text(reply, ":A ");
        return tuner.failed ? STATUS_FAILED : STATUS_OK;
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (request_argument(request, axis_letter(axis)) != NULL) {
            if (!motion_ready(axis) || motion_axis_busy(axis) || !comes_to_rest(axis) ||
                find_room(axis) == 0)
                return STATUS_FAILED;
            axes |= MOTION_AXIS(axis);
        }
    if (!motion_claim(axes, &owner))
        return STATUS_FAILED;
    tuner.axes = axes;
    reply->step = 1;
    next_axis();
    return STATUS_PENDING;
}

static void init(void)
{
    recording = false;
    tuner.phase = PHASE_NONE;
    tuner.axes = 0;
}

static const struct command commands[] = {
    {
        .name = "AZERO", .shortcut = "AZ", .flags = COMMAND_NEEDS_ARGUMENT, .run = azero,
        .accepts = ARGUMENT_BARE,
        .summary = "Measure the motors of axes and set their gains: KP, KI, KD, KV, KADC, KF. An "
                   "axis goes to and fro for some tenths of a second; the answer comes at the end.",
    },
    {0},
};

static const struct subscription subscriptions[] = {
    {EVENT_SERVO_TURN, EVENT_IN_INTERRUPT, record},
    {0},
};

const struct module tuner_module = {
    .name = "tuner",
    .commands = commands,
    .subscriptions = subscriptions,
    .init = init,
    .poll = poll,
};
