/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/scan_run.h"

#include <math.h>
#include <stddef.h>

#include "core/events.h"
#include "core/fault.h"
#include "hal/compare.h"
#include "hal/divider.h"
#include "hal/identity.h"
#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "modules/tuning.h"

/* How fast an axis is moved, as it was set when the scan started. */
struct pace {
    double counts_per_s;
    double ramp_ms;
};

/* A scan in progress. */
static struct {
    enum scan_state state;
    struct scan_setup setup;
    struct scan_plan plan;
    struct pace line_pace, retrace_pace, slow_pace;
    int32_t slow_first, slow_last; /* counts: first line, and the one after the last */
    uint32_t line;                 /* lines completed: the number of the one in hand */
    unsigned axes;                 /* that are claimed */
} scan = {.state = SCAN_IDLE};

static bool refuse(unsigned axis, const struct motion_owner *to);
static void ended(unsigned axis, enum motion_end why);

static const struct motion_owner owner = {
    .name = "scan", .busy = true, .holds = true, .letter = 'B',
    .yield = refuse, .ended = ended,
};

/* A scan lets nobody else move its axes: the next line would not be where it belongs. */
static bool refuse(unsigned axis, const struct motion_owner *to)
{
    (void)axis;
    (void)to;
    return false;
}

enum scan_state scan_run_state(void)
{
    return scan.state;
}

uint32_t scan_run_lines_done(void)
{
    return scan.line;
}

static const struct scan_line *line_in_hand(void)
{
    return scan.setup.serpentine && scan.line % 2 == 1 ? &scan.plan.back : &scan.plan.forward;
}

static int32_t slow_counts(uint32_t line)
{
    const double way = (double)scan.slow_last - scan.slow_first;

    return (int32_t)lround(scan.slow_first + way * line / scan.setup.lines);
}

/* --- check and start ------------------------------------------------------------------------- */

static bool within(int32_t counts, unsigned axis)
{
    return counts > -COORDINATES_COUNTS_MAX && counts < COORDINATES_COUNTS_MAX &&
           limits_allow(axis, counts);
}

static enum status plan_fast_axis(const struct scan_setup *setup, struct scan_plan *plan)
{
    const unsigned fast = (unsigned)setup->fast;
    const struct scan_axis axis = {
        .counts_per_mm = coordinates_counts_per_mm(fast),
        .speed_mm_per_s = tuning_speed_mm_per_s(fast),
        .speed_max_mm_per_s = motion_speed_max_mm_per_s(fast),
        /* The jerk lengthens a change of speed by its own time (servo/profile.h). */
        .accel_ms = tuning_ramp_ms(fast) + tuning_jerk_ticks(fast) * AXIS_TICK_US / 1e3,
        .start_count = coordinates_mm_to_counts(fast, setup->line.start_mm),
        .mirrored = coordinates_mirrored(fast),
        .fast_clock_hz = identity_fast_clock_rate_hz(),
    };

    if (scan_plan_make(&setup->line, &axis, plan) != SCAN_PLAN_OK ||
        !within(plan->forward.from_count, fast) || !within(plan->forward.to_count, fast))
        return STATUS_RANGE;
    return STATUS_OK;
}

static enum status prepare(const struct scan_setup *setup, struct scan_plan *plan)
{
    if (setup->fast == SCAN_NO_AXIS || setup->fast == setup->slow || setup->lines == 0)
        return STATUS_RANGE;

    const enum status status = plan_fast_axis(setup, plan);
    if (status != STATUS_OK)
        return status;
    if (!motion_ready((unsigned)setup->fast))
        return STATUS_FAILED;
    if (setup->slow != SCAN_NO_AXIS) {
        const unsigned slow = (unsigned)setup->slow;
        const double last_mm = scan_plan_slow_mm(setup->slow_start_mm, setup->slow_stop_mm,
                                                 setup->lines, setup->lines - 1);

        if (!within(coordinates_mm_to_counts(slow, setup->slow_start_mm), slow) ||
            !within(coordinates_mm_to_counts(slow, last_mm), slow))
            return STATUS_RANGE;
        if (!motion_ready(slow))
            return STATUS_FAILED;
    }
    return STATUS_OK;
}

enum status scan_run_check(const struct scan_setup *setup)
{
    struct scan_plan plan;

    return prepare(setup, &plan);
}

static struct pace pace_of(int axis, double speed_mm_per_s)
{
    return (struct pace){
        .counts_per_s = tuning_counts_per_s((unsigned)axis, speed_mm_per_s),
        .ramp_ms = tuning_ramp_ms((unsigned)axis),
    };
}

static void go(int axis, int32_t target_counts, const struct pace *pace)
{
    const struct motion_move move = {
        .axis = (unsigned)axis, .target_counts = target_counts,
        .speed_counts_per_s = pace->counts_per_s, .ramp_ms = pace->ramp_ms,
    };

    motion_start(&move, 1);
}

static void go_to_run_up(void)
{
    go(scan.setup.fast, line_in_hand()->from_count, &scan.retrace_pace);
}

static void go_to_slow_line(void)
{
    const int slow = scan.setup.slow;

    if (slow != SCAN_NO_AXIS)
        go(slow, slow_counts(scan.line), &scan.slow_pace);
}

enum status scan_run_start(const struct scan_setup *setup)
{
    struct scan_plan plan;
    const enum status status = prepare(setup, &plan);
    unsigned axes = 0;

    if (status != STATUS_OK)
        return status;
    axes |= MOTION_AXIS((unsigned)setup->fast);
    if (setup->slow != SCAN_NO_AXIS)
        axes |= MOTION_AXIS((unsigned)setup->slow);
    if (scan.state != SCAN_IDLE || !motion_claim(axes, &owner))
        return STATUS_FAILED;

    scan.setup = *setup;
    scan.plan = plan;
    scan.line = 0;
    scan.axes = axes;
    scan.line_pace = pace_of(setup->fast, tuning_speed_mm_per_s((unsigned)setup->fast));
    scan.retrace_pace = pace_of(setup->fast, motion_speed_max_mm_per_s((unsigned)setup->fast) *
                                                 setup->retrace_percent / 100);
    if (setup->slow != SCAN_NO_AXIS) {
        scan.slow_first = coordinates_mm_to_counts((unsigned)setup->slow, setup->slow_start_mm);
        scan.slow_last = coordinates_mm_to_counts((unsigned)setup->slow, setup->slow_stop_mm);
        scan.slow_pace = pace_of(setup->slow, tuning_speed_mm_per_s((unsigned)setup->slow));
    }
    /* The fast axis may be under way for its former owner: where it is going is no business of
     * ours. */
    scan.state = SCAN_START;
    go_to_slow_line();
    if (setup->slow == SCAN_NO_AXIS)
        go_to_run_up();
    return STATUS_OK;
}

/* --- ends ------------------------------------------------------------------------------------ */

static bool at_rest(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((scan.axes & MOTION_AXIS(axis)) != 0 && !motion_in_position(axis))
            return false;
    return true;
}

/* At rest, or out of control: nothing is left to wait for. */
static bool is_over(unsigned axis)
{
    struct axis_view view;

    axis_read(axis, &view);
    return view.off || motion_in_position(axis);
}

static bool all_over(void)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if ((scan.axes & MOTION_AXIS(axis)) != 0 && !is_over(axis))
            return false;
    return true;
}

static void finish(void)
{
    motion_release(scan.axes, &owner);
    scan.state = SCAN_IDLE;
}

void scan_run_init(void)
{
    compare_disarm();
    scan.state = SCAN_IDLE;
    scan.axes = 0;
    scan.line = 0;
}

/* End the line in the gateware (SYNC falls, no more pulses) and brake. */
static void brake(enum scan_state state)
{
    compare_disarm();
    scan.state = state;
    motion_stop(scan.axes);
}

static void fail(enum fault code)
{
    log_error((uint16_t)code);
    brake(SCAN_ERROR);
}

void scan_run_stop(void)
{
    if (scan.state != SCAN_IDLE && scan.state != SCAN_ERROR)
        brake(SCAN_STOP);
}

/* What a line lacks when it ends where it is. */
static enum fault missing(void)
{
    return scan.state == SCAN_ACTIVE ? FAULT_SCAN_INCOMPLETE : FAULT_SCAN_LOST_PULSES;
}

/* HALT, a limit, a fault: the axis is braking or held already. The others must not go on alone. A
 * fault in a line, as of an encoder that is silent, leaves it short of pulses. */
static void ended(unsigned axis, enum motion_end why)
{
    const bool in_line = scan.state == SCAN_ACCELERATE || scan.state == SCAN_ACTIVE;

    (void)axis;
    if (scan.state == SCAN_IDLE)
        return;
    if (in_line && (why == MOTION_FAULT || why == MOTION_LIMIT))
        log_error((uint16_t)missing());
    brake(why == MOTION_HALTED ? SCAN_STOP : SCAN_ERROR);
}

/* --- lines ----------------------------------------------------------------------------------- */

/* Both axes stand before the line. False: the gateware did not take it, nothing is armed. */
static bool arm_line(void)
{
    const struct scan_line *line = line_in_hand();
    const struct scan_setup *setup = &scan.setup;
    const struct divider_line pixels = {
        .axis = (unsigned)setup->encoder_axis, .whole = scan.plan.pitch_whole,
        .fraction = scan.plan.pitch_fraction, .phase = line->phase, .pixels = scan.plan.pixels,
        .width_fast = scan.plan.width_fast, .interval_min_fast = scan.plan.interval_min_fast,
        .emit = setup->pulses,
    };

    divider_load(&pixels);
    compare_arm((unsigned)setup->sync_axis, line->reference_edge, line->reverse);

    const bool armed = compare_status().armed;
    /* Events of a line that was stopped may still be there. The stage stands: none is of this. */
    (void)compare_take_events();
    return armed;
}

static void begin_line(void)
{
    if (!arm_line()) {
        fail(FAULT_SCAN_LOST_PULSES);
        return;
    }
    go(scan.setup.fast, line_in_hand()->to_count, &scan.line_pace);
    scan.state = SCAN_ACCELERATE;
}

/* The stage is at rest behind the line. */
static void next_line(void)
{
    scan.line++;
    if (scan.line == scan.setup.lines) {
        finish();
    } else if (scan.setup.serpentine) {
        scan.state = SCAN_SLOW_STEP;
        go_to_slow_line();
    } else {
        scan.state = SCAN_RETRACE;
        go_to_run_up();
    }
}

/* The motion is read before the events: whoever finds the stage at rest then sees them all. The
 * gateware keeps each event until it is read, and a line is armed only after the one before it is
 * over, so nothing is lost however seldom this runs. */
static void poll_line(void)
{
    const bool rest = at_rest();
    const struct compare_events events = compare_take_events();

    if (scan.state == SCAN_ACCELERATE && events.started) {
        scan.state = SCAN_ACTIVE;
        events_publish(EVENT_LINE_START, scan.line, events_now());
    }
    if (scan.state == SCAN_ACTIVE && events.finished) {
        struct divider_result result;

        divider_read(&result);
        events_publish(EVENT_LINE_END, result.produced, events_now());
        scan.state = SCAN_OVERRUN;
        if (result.produced != scan.plan.pixels || result.end_counts != line_in_hand()->end_count)
            fail(FAULT_SCAN_INCOMPLETE);
        else if (result.merged) /* fewer pulses than pixels */
            fail(FAULT_SCAN_LOST_PULSES);
    } else if (rest) {
        fail(missing());
    }
}

void scan_run_poll(void)
{
    switch (scan.state) {
    case SCAN_IDLE:
        break;
    case SCAN_START:
        scan.state = scan.setup.slow == SCAN_NO_AXIS ? SCAN_RUN_UP : SCAN_SLOW_FIRST;
        break;
    case SCAN_SLOW_FIRST:
        if (motion_in_position((unsigned)scan.setup.slow)) {
            scan.state = SCAN_RUN_UP;
            go_to_run_up();
        }
        break;
    case SCAN_RETRACE:
        if (at_rest()) {
            scan.state = SCAN_SLOW_STEP;
            go_to_slow_line();
        }
        break;
    case SCAN_RUN_UP:
    case SCAN_SLOW_STEP:
        if (at_rest())
            scan.state = SCAN_SETTLE;
        break;
    case SCAN_SETTLE:
        if (at_rest())
            begin_line();
        break;
    case SCAN_ACCELERATE:
    case SCAN_ACTIVE:
        poll_line();
        break;
    case SCAN_OVERRUN:
        if (at_rest())
            next_line();
        break;
    case SCAN_STOP:
    case SCAN_ERROR:
        if (all_over())
            finish();
        break;
    }
}
