/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/scan_plan.h"

#include <math.h>

#define MILLION 1000000

/* Longest pulse the firmware chooses by itself. */
static const double WIDTH_DEFAULT_MAX_US = 10.0;

/* The gateware arms only when this many clocks stay low between two pulses at the axis' maximum
 * speed. */
static const uint32_t WIDTH_LOW_MIN_FAST = 2;

/* Beyond these no line lies within the 32-bit counts, and the integers below would overflow. */
static const double LENGTH_MAX_MM = 1e6;
static const double COUNTS_PER_MM_MAX = 1e9;

/** Millionths, to the nearest: nanometres of mm, millionths of counts. |value| is below 10^12. */
static int64_t to_millionths(double value)
{
    return (int64_t)llround(value * MILLION);
}

/** The settings as integers: decimals such as 0.1 mm are exact here and are not in binary. */
struct integers {
    bool falling;              /* stop lies below start, in user coordinates */
    uint64_t pitch_millionths; /* counts / 10^6 per pixel */
    uint32_t pixels;
};

/* 2^31 counts, in millionths: more than any line within the 32-bit counts. */
static const uint64_t LENGTH_LIMIT = (UINT64_C(1) << 31) * MILLION;

/** Length of the line in millionths of a count, rounded down; saturates at LENGTH_LIMIT. */
static uint64_t length_millionths(uint64_t length_nm, uint64_t counts_per_mm_millionths)
{
    const uint64_t whole = counts_per_mm_millionths / MILLION;
    const uint64_t part = counts_per_mm_millionths % MILLION;

    if (whole != 0 && length_nm > LENGTH_LIMIT / whole)
        return LENGTH_LIMIT;
    /* length_nm < 2^41 and part < 2^20: the product stays below 2^61. */
    const uint64_t length = whole * length_nm + part * length_nm / MILLION;
    return length < LENGTH_LIMIT ? length : LENGTH_LIMIT;
}

static enum scan_plan_status to_integers(const struct scan_settings *settings, double counts_per_mm,
                                         struct integers *line)
{
    if (!(settings->pitch_counts >= 1.0 && settings->pitch_counts < 2147483648.0))
        return SCAN_PLAN_PITCH;
    if (!(fabs(settings->start_mm) <= LENGTH_MAX_MM && fabs(settings->stop_mm) <= LENGTH_MAX_MM &&
          counts_per_mm > 0.0 && counts_per_mm <= COUNTS_PER_MM_MAX))
        return SCAN_PLAN_RANGE;

    const int64_t length_nm = to_millionths(settings->stop_mm) - to_millionths(settings->start_mm);

    line->falling = length_nm < 0;
    line->pitch_millionths = (uint64_t)to_millionths(settings->pitch_counts);
    line->pixels = settings->pixels;
    if (line->pixels == 0) {
        if (length_nm == 0)
            return SCAN_PLAN_NO_LENGTH;

        const uint64_t length =
            length_millionths((uint64_t)(line->falling ? -length_nm : length_nm),
                              (uint64_t)to_millionths(counts_per_mm));
        if (length == LENGTH_LIMIT)
            return SCAN_PLAN_RANGE;
        line->pixels = (uint32_t)(length / line->pitch_millionths);
        if (line->pixels == 0)
            return SCAN_PLAN_NO_PIXELS;
    }
    /* Below this the products of the plan fit 64 bits. */
    if (line->pitch_millionths >= LENGTH_LIMIT / line->pixels)
        return SCAN_PLAN_RANGE;
    return SCAN_PLAN_OK;
}

uint32_t scan_plan_pixels(const struct scan_settings *settings, double counts_per_mm)
{
    struct integers line;

    return to_integers(settings, counts_per_mm, &line) == SCAN_PLAN_OK ? line.pixels : 0;
}

double scan_plan_stop_mm(const struct scan_settings *settings, double counts_per_mm)
{
    if (settings->pixels == 0)
        return settings->stop_mm;

    const double length_mm = settings->pixels * settings->pitch_counts / counts_per_mm;
    return settings->stop_mm < settings->start_mm ? settings->start_mm - length_mm
                                                  : settings->start_mm + length_mm;
}

double scan_plan_slow_mm(double start_mm, double stop_mm, uint32_t lines, uint32_t line)
{
    return start_mm + (stop_mm - start_mm) * line / lines;
}

static uint32_t saturate_u32(double value)
{
    return value >= 4294967295.0 ? UINT32_MAX : (uint32_t)value;
}

/**
 * Choose the pulse width, in fast clocks.
 *
 * @return  0 when the width that was set cannot be made or would leave too little between two
 * pulses.
 */
static uint32_t choose_width(const struct scan_settings *settings, const struct scan_axis *axis,
                             uint32_t interval_min)
{
    uint32_t longest = interval_min > WIDTH_LOW_MIN_FAST ? interval_min - WIDTH_LOW_MIN_FAST : 0;
    if (longest > SCAN_PLAN_WIDTH_MAX)
        longest = SCAN_PLAN_WIDTH_MAX;

    const double clocks_per_us = axis->fast_clock_hz / 1e6;

    if (settings->width_us > 0.0) {
        const double width = floor(settings->width_us * clocks_per_us + 0.5);
        return width >= 1.0 && width <= longest ? (uint32_t)width : 0;
    }

    const double half_pixel_us =
        settings->pitch_counts / (axis->speed_mm_per_s * axis->counts_per_mm) / 2.0 * 1e6;
    const double width_us = fmin(half_pixel_us, WIDTH_DEFAULT_MAX_US);
    const uint32_t width = saturate_u32(width_us * clocks_per_us);

    return width < longest ? width : longest;
}

static bool fits_count(int64_t value)
{
    return value >= INT32_MIN && value <= INT32_MAX;
}

enum scan_plan_status scan_plan_make(const struct scan_settings *settings,
                                     const struct scan_axis *axis, struct scan_plan *plan)
{
    struct integers line;
    struct scan_plan made;
    const enum scan_plan_status status = to_integers(settings, axis->counts_per_mm, &line);

    if (status != SCAN_PLAN_OK)
        return status;
    if (!(axis->speed_mm_per_s > 0.0 && axis->speed_max_mm_per_s > 0.0))
        return SCAN_PLAN_SPEED;

    /* Rounding the pitch down keeps ceil(k * pitch) that of the decimal pitch, for k up to 2^32
     * over 10 to the number of its decimals: a pitch a hair too large would push each pixel that
     * should fall on a whole count one count on. */
    made.pixels = line.pixels;
    made.pitch_whole = (uint32_t)(line.pitch_millionths / MILLION);
    made.pitch_fraction = (uint32_t)(((line.pitch_millionths % MILLION) << 32) / MILLION);

    /* Edges of the line: ceil(pixels * pitch). What is left of the last edge is the phase that lets
     * the return line fall on the same edges, since
     * length - ceil((pixels - k) * pitch) = floor(k * pitch + phase). */
    const uint64_t pitch_q32 = ((uint64_t)made.pitch_whole << 32) | made.pitch_fraction;
    const uint64_t length_q32 = made.pixels * pitch_q32;
    const int64_t length = (int64_t)((length_q32 + UINT32_MAX) >> 32);
    const uint32_t phase_back = (uint32_t)(0u - (uint32_t)length_q32);

    const double run_ms = axis->accel_ms / 2.0 + settings->settle_ms;
    const double run_mm = axis->speed_mm_per_s * run_ms / 1e3 + settings->overshoot_mm;
    const double run_counts = ceil(run_mm * axis->counts_per_mm) + SCAN_PLAN_MARGIN_COUNTS;
    if (!(run_counts >= 0.0 && run_counts < 2147483648.0))
        return SCAN_PLAN_RANGE;

    const bool reverse = line.falling != axis->mirrored;
    const int64_t step = reverse ? -1 : 1;
    const int64_t start = axis->start_count;
    /* The edge that is crossed when the count becomes `start`. */
    const int64_t reference = reverse ? start + 1 : start;
    const int64_t end = start + step * length;
    const int64_t from = start - step * (int64_t)run_counts;
    const int64_t to = end + step * (int64_t)run_counts;
    if (!fits_count(from) || !fits_count(to))
        return SCAN_PLAN_RANGE;

    made.forward = (struct scan_line){
        .reference_edge = (int32_t)reference, .reverse = reverse, .phase = UINT32_MAX,
        .end_count = (int32_t)end, .from_count = (int32_t)from, .to_count = (int32_t)to,
    };
    made.back = (struct scan_line){
        .reference_edge = (int32_t)(reference + step * length), .reverse = !reverse,
        .phase = phase_back, .end_count = (int32_t)(start - step),
        .from_count = (int32_t)to, .to_count = (int32_t)from,
    };

    /* With a fraction in the pitch the shortest pixel has its whole part. */
    const double counts_per_s_max = axis->speed_max_mm_per_s * axis->counts_per_mm;
    made.interval_min_fast =
        saturate_u32(made.pitch_whole * (double)axis->fast_clock_hz / counts_per_s_max);
    made.width_fast = choose_width(settings, axis, made.interval_min_fast);
    if (made.width_fast == 0)
        return SCAN_PLAN_WIDTH;

    *plan = made;
    return SCAN_PLAN_OK;
}
