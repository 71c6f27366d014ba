/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/joystick.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "core/axis.h"
#include "hal/adc.h"
#include "hal/knob.h"
#include "modules/coordinates.h"
#include "modules/limits.h"
#include "modules/motion.h"
#include "modules/tuning.h"

/* Time between two looks at the hand: making a plan takes the processor up to a millisecond. */
#define LOOK_FAST (20 * EVENTS_FAST_PER_MS)

/* Of half the range: what counts as the middle, and how much a deflection must change. */
#define DEADBAND 0.06
#define NOTICE 0.01

/* Distance of one edge of a wheel at 100 %. */
#define WHEEL_MM_PER_EDGE 0.01

#define NO_CHANNEL ADC_CHANNELS
#define NO_KNOB KNOB_COUNT

/* What can be connected to an axis, by the numbers of JOYSTICK. */
enum { DEVICE_NONE = 0, DEVICE_FACTORY = 1, DEVICE_MAX = 23 };

static const struct device {
    unsigned number;
    unsigned channel; /* of the analog inputs, or NO_CHANNEL */
    unsigned knob;    /* or NO_KNOB */
    const char *name;
} devices[] = {
    {DEVICE_NONE, NO_CHANNEL, NO_KNOB, "NONE"},
    {2, 0, NO_KNOB, "JS_X"},
    {3, 1, NO_KNOB, "JS_Y"},
    {4, NO_CHANNEL, KNOB_CONTROL, "KNOB"},
    {5, NO_CHANNEL, KNOB_X, "X_WHEEL"},
    {6, NO_CHANNEL, KNOB_Y, "Y_WHEEL"},
    {7, 2, NO_KNOB, "ADC_1"},
    {9, 0, KNOB_X, "JS_X+WHL"},
    {10, 1, KNOB_Y, "JS_Y+WHL"},
    {22, NO_CHANNEL, KNOB_CONTROL, "Z_WHEEL"},
    {23, NO_CHANNEL, KNOB_X, "F_WHEEL"},
};

/* Of X, Y, Z and F. */
static const double factory_device[] = {2, 3, 4, 23};

static double device_of[AXIS_COUNT];
static double fast_percent, slow_percent, knob_percent, wheel_fast_percent, wheel_slow_percent;
static bool slow, knob_shifted;

/* What a hand does to an axis. */
static struct hand {
    double deflection; /* that the axis is driven with: -1 to 1; 0: it is not */
    double refused;    /* sign of the deflection that moves nothing, until the hand lets go */
    double rest_counts; /* part of a count that a wheel has turned and nobody has moved */
} hands[AXIS_COUNT];

static int16_t knob_seen[KNOB_COUNT];
static int32_t knob_turned[KNOB_COUNT]; /* edges since the last look */
static uint64_t look_due_fast;

static const struct device *find(double number)
{
    for (size_t i = 0; i < sizeof devices / sizeof devices[0]; i++)
        if (devices[i].number == (unsigned)number)
            return &devices[i];
    return NULL;
}

static const struct device *connected(unsigned axis)
{
    return find(device_of[axis]);
}

bool joystick_connected(unsigned axis)
{
    return device_of[axis] != DEVICE_NONE;
}

const char *joystick_device_name(unsigned axis)
{
    return connected(axis)->name;
}

/* --- Motion ----------------------------------------------------------------------------------- */

/* Whatever ended it, a joystick still held must not start again by itself. */
static void ended(unsigned axis, enum motion_end why)
{
    (void)why;
    /* May be told twice: HALT is, as it comes in and in its turn. */
    if (hands[axis].deflection != 0)
        hands[axis].refused = hands[axis].deflection;
    hands[axis].deflection = 0;
}

static const struct motion_owner owner = {.name = "joystick", .letter = 'M', .ended = ended};

static double max_counts_per_s(unsigned axis)
{
    return tuning_counts_per_s(axis, motion_speed_max_mm_per_s(axis));
}

static void start(unsigned axis, int32_t target_counts, double speed_counts_per_s)
{
    const struct motion_move move = {
        .axis = axis,
        .target_counts = target_counts,
        .speed_counts_per_s = speed_counts_per_s,
        .ramp_ms = tuning_ramp_ms(axis) * speed_counts_per_s / max_counts_per_s(axis),
    };

    motion_start(&move, 1);
}

/* A hand may have the axis: it is free, or has been the hand's. */
static bool may_move(unsigned axis)
{
    return motion_ready(axis) && !motion_axis_busy(axis) &&
           motion_claim(MOTION_AXIS(axis), &owner);
}

static void let_go(unsigned axis)
{
    hands[axis].deflection = 0;
    motion_stop(MOTION_AXIS(axis));
    motion_release(MOTION_AXIS(axis), &owner);
}

/* Deflection of a joystick, -1 to 1, 0 within the deadband. Mostly it is: that is told in integers. */
static double deflection(const struct device *device)
{
    int32_t off;
    double value;

    if (device->channel == NO_CHANNEL || !adc_valid())
        return 0;
    off = (int32_t)adc_read(device->channel) - ADC_FULL / 2;
    if (abs(off) <= (int32_t)(DEADBAND * ADC_FULL / 2))
        return 0;
    value = off / (ADC_FULL / 2.0);
    return copysign((fabs(value) - DEADBAND) / (1 - DEADBAND), value);
}

/* Signed share of the axis' maximum speed: a square law, for fine work near the middle. */
static double share_of_speed(double deflected)
{
    const double percent = slow ? slow_percent : fast_percent;

    return deflected * fabs(deflected) * percent / 100;
}

static void drive(unsigned axis, double deflected)
{
    struct hand *hand = &hands[axis];
    double share;
    int32_t target_counts;

    if (deflected == 0 || deflected * hand->refused < 0)
        hand->refused = 0;
    if (hand->refused != 0)
        return;
    if (deflected == 0) {
        if (hand->deflection != 0)
            let_go(axis);
        return;
    }
    if (hand->deflection * deflected > 0 && fabs(hand->deflection - deflected) < NOTICE)
        return;
    share = share_of_speed(deflected);
    target_counts =
        limits_nearest(axis, motion_position_counts(axis),
                       share > 0 ? COORDINATES_COUNTS_MAX : -COORDINATES_COUNTS_MAX);
    if ((share > 0) != (target_counts > motion_position_counts(axis)) || !may_move(axis))
        return;
    hand->deflection = deflected;
    start(axis, target_counts, fabs(share) * max_counts_per_s(axis));
}

static double wheel_percent(unsigned knob)
{
    if (knob == KNOB_CONTROL)
        return knob_percent;
    return slow ? wheel_slow_percent : wheel_fast_percent;
}

static void turn(unsigned axis, unsigned knob, int32_t edges)
{
    struct hand *hand = &hands[axis];
    const double counts_per_edge =
        WHEEL_MM_PER_EDGE * coordinates_counts_per_mm(axis) * wheel_percent(knob) / 100;
    double whole_counts;

    if (edges == 0 || hand->deflection != 0 || !may_move(axis))
        return;
    hand->rest_counts = modf(hand->rest_counts + edges * counts_per_edge, &whole_counts);
    if (whole_counts != 0)
        start(axis, limits_nearest(axis, motion_place_counts(axis),
                                   motion_target_counts(axis) + (int32_t)whole_counts),
              tuning_counts_per_s(axis, tuning_speed_mm_per_s(axis)));
}

/* The knob that moves an axis; the control knob may have gone over to the last one. */
static unsigned knob_of(unsigned axis)
{
    const unsigned knob = connected(axis)->knob;

    if (!knob_shifted)
        return knob;
    if (axis == AXIS_COUNT - 1)
        return KNOB_CONTROL;
    return knob == KNOB_CONTROL ? NO_KNOB : knob;
}

static void look(void)
{
    for (unsigned knob = 0; knob < KNOB_COUNT; knob++) {
        const int16_t position = knob_position((enum knob)knob);

        knob_turned[knob] = (int16_t)(uint16_t)((uint16_t)position - (uint16_t)knob_seen[knob]);
        knob_seen[knob] = position;
    }
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const unsigned knob = knob_of(axis);

        drive(axis, deflection(connected(axis)));
        if (knob != NO_KNOB)
            turn(axis, knob, knob_turned[knob]);
    }
}

static void poll(void)
{
    const uint64_t now_fast = axis_time_fast();

    if (now_fast < look_due_fast)
        return;
    look_due_fast = now_fast + LOOK_FAST;
    look();
}

bool joystick_toggle_speed(void)
{
    slow = !slow;
    /* Axes that are driven take it up at the next look. */
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        if (hands[axis].deflection != 0)
            hands[axis].deflection = copysign(2, hands[axis].deflection);
    return true;
}

void joystick_toggle_knob(void)
{
    knob_shifted = !knob_shifted;
}

static void init(void)
{
    slow = false;
    knob_shifted = false;
    look_due_fast = 0;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        hands[axis] = (struct hand){0};
    for (unsigned knob = 0; knob < KNOB_COUNT; knob++)
        knob_seen[knob] = knob_position((enum knob)knob);
}

/* --- Settings --------------------------------------------------------------------------------- */

static enum status check_device(unsigned axis, double number)
{
    (void)axis;
    return number == DEVICE_FACTORY || find(number) != NULL ? STATUS_OK : STATUS_RANGE;
}

static double adjust_device(unsigned axis, double number)
{
    return number == DEVICE_FACTORY ? factory_device[axis] : number;
}

static void set_device(unsigned axis, double number)
{
    (void)number;
    if (hands[axis].deflection != 0)
        let_go(axis);
}

static enum status sign_device(unsigned axis, bool plus, bool act)
{
    if (act) {
        device_of[axis] = plus ? factory_device[axis] : DEVICE_NONE;
        set_device(axis, device_of[axis]);
    }
    return STATUS_OK;
}

static enum status check_percent(unsigned axis, double percent)
{
    (void)axis;
    return fabs(percent) >= 0.1 ? STATUS_OK : STATUS_RANGE;
}

#define PERCENT                                                                                    \
    .command = "JSSPD", .type = PARAMETER_REAL, .decimals_max = 3, .unit = "%", .minimum = -100,   \
    .maximum = 100, .check = check_percent, .taken = "-100 ... -0.1, 0.1 ... 100",                 \
    .saved = SAVED_BY_SS

static const struct parameter parameters[] = {
    {
        .command = "JOYSTICK", .letter = PARAMETER_AXES, .type = PARAMETER_INTEGER, .unit = "",
        .minimum = DEVICE_NONE, .maximum = DEVICE_MAX, .initial = DEVICE_FACTORY,
        .value = device_of, .check = check_device, .adjust = adjust_device, .set = set_device,
        .sign = sign_device, .saved = SAVED_BY_SS,
        .summary = "Input device: 0 none, 1 the factory's, 2 joystick X, 3 joystick Y, 4 control "
                   "knob, 5 X wheel, 6 Y wheel, 7 analog input Z, 9 and 10 joystick and wheel of "
                   "X and Y, 22 and 23 wheels of Z and F; + connects the factory's, - none.",
    },
    {
        PERCENT, .letter = 'X', .initial = 100, .value = &fast_percent,
        .summary = "Fast: share of the maximum speed at full deflection; negative turns it round.",
    },
    {
        PERCENT, .letter = 'Y', .initial = 5, .value = &slow_percent,
        .summary = "Slow: the same after the joystick's button.",
    },
    {
        PERCENT, .letter = 'Z', .initial = 5, .value = &knob_percent,
        .summary = "Control knob: share of 10 um for each edge.",
    },
    {
        PERCENT, .letter = 'F', .initial = 100, .value = &wheel_fast_percent,
        .summary = "Wheels, fast: share of 10 um for each edge.",
    },
    {
        PERCENT, .letter = 'T', .initial = 5, .value = &wheel_slow_percent,
        .summary = "Wheels, slow.",
    },
    {0},
};

static const struct command commands[] = {
    {.name = "JOYSTICK", .shortcut = "J", .form = FORM_P, .summary = "Input devices of axes."},
    {.name = "JSSPD", .shortcut = "JS", .form = FORM_P, .summary = "Speeds of input devices."},
    {0},
};

const struct module joystick_module = {
    .name = "joystick",
    .commands = commands,
    .parameters = parameters,
    .init = init,
    .poll = poll,
};
