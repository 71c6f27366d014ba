/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/scan_settings.h"

#include <math.h>
#include <stddef.h>

#include "modules/coordinates.h"
#include "modules/pins.h"
#include "modules/scan_roles.h"

/* What the original's variables hold (SCAN C). */
enum {
    ORIGINAL_PITCH_MIN = 8,
    ORIGINAL_COUNT_MAX = 32767,
    ORIGINAL_COUNTS_PER_EDGE = 4, /* it sees the rising edges of one channel */
    ORIGINAL_WIRED_AXES = 2,      /* X and Y */
};

/* What the parameter rows hold. Pixels: 0 while the stop decides. */
static double start_mm, stop_mm, pitch_counts, pixels, retrace_percent, width_us, direct;
static double slow_start_mm, slow_stop_mm, lines, settle_ms, overshoot_mm, sync_axis, encoder_axis;
static double pattern, fast_axis, slow_axis, dialect, original, one_connector;

static int axis_or_none(double value)
{
    return value < AXIS_COUNT ? (int)value : SCAN_NO_AXIS;
}

static double whole_edges(double counts)
{
    return floor(counts / ORIGINAL_COUNTS_PER_EDGE) * ORIGINAL_COUNTS_PER_EDGE;
}

/* The line as it stands, for the planner. */
static struct scan_settings line_settings(void)
{
    return (struct scan_settings){
        .start_mm = start_mm, .stop_mm = stop_mm, .pixels = (uint32_t)pixels,
        .pitch_counts = original != 0 ? whole_edges(pitch_counts) : pitch_counts,
        .width_us = width_us, .settle_ms = settle_ms, .overshoot_mm = overshoot_mm,
    };
}

/* The axis that a jumper (SCANV R, M) takes a signal from. */
static int jumpered(double jumper, int fast)
{
    if (jumper != 0)
        return (int)jumper - 1;
    return original != 0 && fast >= ORIGINAL_WIRED_AXES ? 0 : fast;
}

static double counts_per_mm(int fast)
{
    return coordinates_counts_per_mm(fast >= 0 ? (unsigned)fast : 0);
}

/* Whether the original's variables could hold the line. */
static bool fits_original(const struct scan_setup *setup)
{
    return setup->line.pitch_counts >= ORIGINAL_PITCH_MIN &&
           setup->line.pitch_counts <= ORIGINAL_COUNT_MAX &&
           scan_plan_pixels(&setup->line, counts_per_mm(setup->fast)) <= ORIGINAL_COUNT_MAX;
}

/* The direct output is there without a scan. */
static void follow_fast_axis(void)
{
    const int axis = jumpered(encoder_axis, axis_or_none(fast_axis));

    if (axis >= 0 && scan_run_state() == SCAN_IDLE)
        pins_encoder_axis((unsigned)axis);
}

enum status scan_settings_setup(int fast, int slow, struct scan_setup *setup)
{
    *setup = (struct scan_setup){
        .line = line_settings(), .fast = axis_or_none(fast), .slow = axis_or_none(slow),
        .slow_start_mm = slow_start_mm, .slow_stop_mm = slow_stop_mm, .lines = (uint32_t)lines,
        .retrace_percent = retrace_percent, .serpentine = pattern != 0,
        .sync_axis = jumpered(sync_axis, axis_or_none(fast)),
        .encoder_axis = jumpered(encoder_axis, axis_or_none(fast)),
        .pulses = pins_pixels_enabled(),
    };
    return original == 0 || fits_original(setup) ? STATUS_OK : STATUS_RANGE;
}

int scan_settings_fast(void)
{
    return (int)fast_axis;
}

int scan_settings_slow(void)
{
    return (int)slow_axis;
}

void scan_settings_set_axes(int fast, int slow)
{
    fast_axis = fast;
    slow_axis = slow;
    follow_fast_axis();
}

bool scan_settings_roles_only(void)
{
    return dialect != 0;
}

/* --- Rows -------------------------------------------------------------------------------------- */

/* A stop that is set takes the place of a number of pixels. */
static void set_stop(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    pixels = 0;
}

static double get_stop(unsigned axis)
{
    const struct scan_settings settings = line_settings();

    (void)axis;
    return scan_plan_stop_mm(&settings, counts_per_mm(axis_or_none(fast_axis)));
}

static double get_pixels(unsigned axis)
{
    const struct scan_settings settings = line_settings();

    (void)axis;
    return scan_plan_pixels(&settings, counts_per_mm(axis_or_none(fast_axis)));
}

static enum status check_width(unsigned axis, double value)
{
    (void)axis;
    return value == 0 || value >= 0.01 ? STATUS_OK : STATUS_RANGE;
}

static enum status check_axis(unsigned axis, double value)
{
    (void)axis;
    return value < AXIS_COUNT || value == SCAN_ROLES_NONE ? STATUS_OK : STATUS_RANGE;
}

static enum status check_pitch(unsigned axis, double value)
{
    (void)axis;
    if (original != 0 && (whole_edges(value) < ORIGINAL_PITCH_MIN || value > ORIGINAL_COUNT_MAX))
        return STATUS_RANGE;
    return STATUS_OK;
}

static double get_pitch(unsigned axis)
{
    (void)axis;
    return line_settings().pitch_counts;
}

static enum status check_pixels(unsigned axis, double value)
{
    (void)axis;
    return original != 0 && value > ORIGINAL_COUNT_MAX ? STATUS_RANGE : STATUS_OK;
}

static void set_one_connector(unsigned axis, double value)
{
    (void)axis;
    pins_encoder_on_out0(value != 0);
}

static void set_direct(unsigned axis, double value)
{
    (void)axis;
    pins_encoder_direct(value != 0);
}

static void set_axis(unsigned axis, double value)
{
    (void)axis;
    (void)value;
    follow_fast_axis();
}

#define LENGTH_MAX_MM 1e5
#define COUNT_MAX 2147483647.0

const struct parameter scan_settings_rows[] = {
    {
        .command = "SCAN", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &pattern, .saved = SAVED_BY_SS,
        .summary = "0 raster, all lines from start to stop; 1 serpentine, every other one back.",
    },
    {
        .command = "SCAN", .letter = 'R', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = SCAN_ROLES_NONE, .initial = 0, .value = &fast_axis,
        .check = check_axis, .set = set_axis, .saved = SAVED_BY_SS,
        .summary = "Number of the fast axis, 9 for none; what SCAN X= Y= Z= come to.",
    },
    {
        .command = "SCAN", .letter = 'T', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = SCAN_ROLES_NONE, .initial = AXIS_COUNT > 1 ? 1 : SCAN_ROLES_NONE,
        .value = &slow_axis, .check = check_axis, .saved = SAVED_BY_SS,
        .summary = "Number of the slow axis, 9 for none.",
    },
    {
        .command = "SCAN", .letter = 'M', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &dialect, .saved = SAVED_BY_SS,
        .summary = "SCAN Y= Z= without X: 0 axis numbers (Y fast, Z slow), 1 always roles.",
    },
    {
        .command = "SCAN", .letter = 'C', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &original, .set = set_axis,
        .saved = SAVED_BY_SS,
        .summary = "1: the original's limits. SCANR Z a multiple of 4 from 8 to 32767, at most "
                   "32767 pixels, and signals of X and Y alone.",
    },
    {
        .command = "SCAN", .letter = 'W', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &one_connector,
        .set = set_one_connector, .saved = SAVED_BY_SS,
        .summary = "1: ENCODER comes out of OUT0 too, in place of what TTL Y says.",
    },
    {
        .command = "SCANR", .letter = 'X', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = -LENGTH_MAX_MM, .maximum = LENGTH_MAX_MM, .initial = 0, .value = &start_mm,
        .saved = SAVED_BY_SS, .summary = "Start of the line.",
    },
    {
        .command = "SCANR", .letter = 'Y', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = -LENGTH_MAX_MM, .maximum = LENGTH_MAX_MM, .initial = 0, .value = &stop_mm,
        .set = set_stop, .get = get_stop, .saved = SAVED_BY_SS,
        .summary = "Stop of the line; takes the place of F.",
    },
    {
        .command = "SCANR", .letter = 'Z', .type = PARAMETER_REAL, .decimals_max = 6,
        .unit = "counts", .minimum = 1, .maximum = COUNT_MAX, .below = OUTSIDE_REFUSE,
        .above = OUTSIDE_REFUSE, .initial = 24, .value = &pitch_counts, .check = check_pitch,
        .taken = "1 ... 2147483647",
        .get = get_pitch, .saved = SAVED_BY_SS,
        .summary = "Encoder counts per pixel; may have a fraction.",
    },
    {
        .command = "SCANR", .letter = 'F', .type = PARAMETER_INTEGER, .unit = "pixels",
        .minimum = 0, .maximum = COUNT_MAX, .initial = 0, .value = &pixels, .check = check_pixels,
        .taken = "0 ... 2147483647",
        .get = get_pixels, .saved = SAVED_BY_SS,
        .summary = "Pixels of the line, from X toward Y; takes the place of Y. 0: as Y says.",
    },
    {
        .command = "SCANR", .letter = 'R', .type = PARAMETER_REAL, .decimals = 6, .unit = "%",
        .minimum = 0.01, .maximum = 100, .initial = 67, .value = &retrace_percent,
        .saved = SAVED_BY_SS, .summary = "Speed of the way back, of the axis' maximum.",
    },
    {
        .command = "SCANR", .letter = 'T', .type = PARAMETER_REAL, .decimals = 6, .unit = "us",
        .minimum = 0, .maximum = 80000, .initial = 0, .value = &width_us, .check = check_width,
        .taken = "0, 0.01 ... 80000",
        .saved = SAVED_BY_SS,
        .summary = "Length of a pixel pulse; 0: half a pixel at the line speed, at most 10 us.",
    },
    {
        .command = "SCANR", .letter = 'M', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = 1, .initial = 0, .value = &direct, .set = set_direct,
        .saved = SAVED_BY_SS,
        .summary = "ENCODER output: 0 pixel pulses (DIVIDE), 1 encoder channel A (DIRECT).",
    },
    {
        .command = "SCANV", .letter = 'X', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = -LENGTH_MAX_MM, .maximum = LENGTH_MAX_MM, .initial = 0,
        .value = &slow_start_mm, .saved = SAVED_BY_SS, .summary = "Place of the first line.",
    },
    {
        .command = "SCANV", .letter = 'Y', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = -LENGTH_MAX_MM, .maximum = LENGTH_MAX_MM, .initial = 0,
        .value = &slow_stop_mm, .saved = SAVED_BY_SS,
        .summary = "Where the line after the last one would be.",
    },
    {
        .command = "SCANV", .letter = 'Z', .type = PARAMETER_INTEGER, .unit = "lines",
        .minimum = 1, .maximum = COUNT_MAX, .initial = 1, .value = &lines, .saved = SAVED_BY_SS,
        .summary = "Number of lines.",
    },
    {
        .command = "SCANV", .letter = 'F', .type = PARAMETER_REAL, .decimals_max = 6, .unit = "ms",
        .minimum = 0, .maximum = 32767, .initial = 10, .value = &settle_ms, .saved = SAVED_BY_SS,
        .summary = "Time at constant speed before the line and after it.",
    },
    {
        .command = "SCANV", .letter = 'T', .type = PARAMETER_REAL, .decimals = 6, .unit = "mm",
        .minimum = 0, .maximum = 1000, .initial = 0, .value = &overshoot_mm, .saved = SAVED_BY_SS,
        .summary = "Way at constant speed before the line and after it, besides F.",
    },
    {
        .command = "SCANV", .letter = 'R', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = AXIS_COUNT, .initial = 0, .value = &sync_axis,
        .saved = SAVED_BY_SS,
        .summary = "Jumper JP1, axis of SYNC: 0 the fast one, 1 X, 2 Y, 3 Z, 4 F.",
    },
    {
        .command = "SCANV", .letter = 'M', .type = PARAMETER_INTEGER, .unit = "",
        .minimum = 0, .maximum = AXIS_COUNT, .initial = 0, .value = &encoder_axis, .set = set_axis,
        .saved = SAVED_BY_SS,
        .summary = "Jumper JP2, axis of ENCODER: as R.",
    },
    {0},
};
