/* SPDX-License-Identifier: BSD-2-Clause */
#include "interlock_model.h"

#include <math.h>
#include <stdlib.h>

#include "host/mmio.h"
#include "regs.h"

enum { ILLEGAL, NO_PROGRESS, OVER_SPEED, FOLLOWING, KINDS };

static const int64_t UNIT_PS = 500000, WINDOW_PS = 100000000, NEVER = INT64_MAX;

static struct axis {
    int32_t count, lowest, highest, window_count;
    int32_t drive;
    double mean, way_drive; /* of the drive; and when way was last made */
    int64_t strong_since, drive_since; /* NEVER: not */
    int forward;
    unsigned illegal;
    bool too_fast;
} axes[4];

static uint32_t kept;
static int64_t off_ps[4], driven_ps[4];
static int64_t window_ps, illegal_ps;
static struct interlock_nearness near;

static uint32_t get(uintptr_t reg, unsigned axis)
{
    return mmio_model_get(reg + 4 * axis);
}

static double excess(unsigned axis)
{
    const bool holds = get(REG_INTERLOCK_CONTROL, 0) >> REG_INTERLOCK_CONTROL_HOLD_SHIFT >> axis & 1;

    return axes[axis].drive - (holds ? axes[axis].way_drive : 0);
}

static int64_t strong_ps(unsigned axis)
{
    return UNIT_PS * get(REG_INTERLOCK_STRONG_TIME0, axis);
}

static int64_t drive_ps(void)
{
    return UNIT_PS * get(REG_INTERLOCK_DRIVE_TIME, 0);
}

static double following_share(unsigned axis)
{
    const int32_t error = (int32_t)((uint32_t)axes[axis].count - get(REG_INTERLOCK_EXPECTED0, axis));
    const uint32_t most = get(REG_INTERLOCK_FOLLOWING_MOST0, axis);

    if ((get(REG_INTERLOCK_CONTROL, 0) >> axis & 1) == 0 || fabs((double)error) < 1)
        return 0;
    return most == 0 ? 2 : fabs((double)error) / most;
}

static uint32_t causes(int64_t now_ps)
{
    uint32_t result = 0;

    for (unsigned n = 0; n < 4; n++) {
        const struct axis *a = &axes[n];
        const bool cause[KINDS] = {
            [ILLEGAL] = a->illegal > get(REG_INTERLOCK_ILLEGAL_MOST, 0),
            [NO_PROGRESS] = (a->strong_since != NEVER && now_ps - a->strong_since >= strong_ps(n)) ||
                            (a->drive_since != NEVER && now_ps - a->drive_since >= drive_ps()),
            [OVER_SPEED] = a->too_fast,
            [FOLLOWING] = following_share(n) > 1,
        };

        for (unsigned kind = 0; kind < KINDS; kind++)
            result |= (uint32_t)cause[kind] << (4 * kind + n);
    }
    return result;
}

static int64_t last_ps;

static void note(double *nearest, double share)
{
    if (share < 1 && share > *nearest)
        *nearest = share;
}

/* Times of standstill run from when the drive became so large, or changed its direction, or way was made. */
static void judge(unsigned n, int64_t now_ps, bool anew)
{
    struct axis *a = &axes[n];
    const double e = excess(n), size = fabs(e);
    const bool holds = get(REG_INTERLOCK_CONTROL, 0) >> REG_INTERLOCK_CONTROL_HOLD_SHIFT >> n & 1;
    const uint32_t least = holds ? get(REG_INTERLOCK_HELD_MOST, 0) : get(REG_INTERLOCK_BREAKAWAY0, n);
    const int forward = e >= 0;

    if (a->strong_since != NEVER)
        note(&near.strong, (double)(now_ps - a->strong_since) / (double)strong_ps(n));
    if (a->drive_since != NEVER)
        note(&near.drive, (double)(now_ps - a->drive_since) / (double)drive_ps());
    anew |= forward != a->forward;
    a->forward = forward;
    if (holds || size < get(REG_INTERLOCK_STRONG, 0))
        a->strong_since = NEVER;
    else if (anew || a->strong_since == NEVER)
        a->strong_since = now_ps;
    if (size < least)
        a->drive_since = NEVER;
    else if (anew || a->drive_since == NEVER)
        a->drive_since = now_ps;
}

void interlock_model_drive(unsigned axis, int64_t now_ps, int32_t steps)
{
    if (interlock_model_off(axis))
        steps = 0;
    if (steps != 0 && steps != axes[axis].drive)
        driven_ps[axis] = now_ps;
    axes[axis].drive = steps;
    judge(axis, now_ps, false);
}

void interlock_model_count(unsigned axis, int64_t now_ps, int32_t count)
{
    struct axis *a = &axes[axis];

    a->count = count;
    if (count < a->lowest)
        a->lowest = count;
    if (count > a->highest)
        a->highest = count;
    if ((uint32_t)(a->highest - a->lowest) >= get(REG_INTERLOCK_WAY, 0)) {
        a->lowest = a->highest = count;
        a->way_drive = a->mean;
        judge(axis, now_ps, true);
    }
    interlock_model_run(now_ps);
}

void interlock_model_illegal(unsigned axis, int64_t now_ps)
{
    axes[axis].illegal++;
    interlock_model_run(now_ps);
}

int64_t interlock_model_next_ps(void)
{
    int64_t next = NEVER;

    for (unsigned n = 0; n < 4; n++) {
        const int64_t strong = axes[n].strong_since, drive = axes[n].drive_since;

        if (strong != NEVER && strong + strong_ps(n) > last_ps && strong + strong_ps(n) < next)
            next = strong + strong_ps(n);
        if (drive != NEVER && drive + drive_ps() > last_ps && drive + drive_ps() < next)
            next = drive + drive_ps();
    }
    return next;
}

static void end_windows(int64_t now_ps)
{
    for (; now_ps >= window_ps; window_ps += WINDOW_PS) {
        for (unsigned n = 0; n < 4; n++) {
            struct axis *a = &axes[n];
            const double share = fabs((double)a->count - a->window_count) / get(REG_INTERLOCK_SPEED_MOST0, n);

            a->too_fast = share > 1;
            note(&near.speed, share);
            a->window_count = a->count;
            a->mean += (a->drive - a->mean) / 64;
        }
        if (window_ps >= illegal_ps) {
            illegal_ps = window_ps + WINDOW_PS * get(REG_INTERLOCK_ILLEGAL_TIME, 0);
            for (unsigned n = 0; n < 4; n++)
                axes[n].illegal = 0;
        }
    }
}

void interlock_model_run(int64_t now_ps)
{
    last_ps = now_ps;
    end_windows(now_ps);
    for (unsigned n = 0; n < 4; n++) {
        judge(n, now_ps, false);
        note(&near.following, following_share(n));
    }
    kept |= causes(now_ps);
    for (unsigned n = 0; n < 4; n++) {
        if (!interlock_model_off(n))
            off_ps[n] = -1;
        else if (off_ps[n] < 0)
            off_ps[n] = now_ps;
        if (interlock_model_off(n) && axes[n].drive != 0)
            interlock_model_drive(n, now_ps, 0);
    }
}

int64_t interlock_model_driven_ps(unsigned axis)
{
    return driven_ps[axis];
}

int64_t interlock_model_off_ps(unsigned axis)
{
    return off_ps[axis];
}

bool interlock_model_off(unsigned axis)
{
    return (kept & (0x1111u << axis | REG_INTERLOCK_FAULTS_WATCHDOG_MASK)) != 0;
}

void interlock_model_reset_processor(void)
{
    kept |= REG_INTERLOCK_FAULTS_WATCHDOG_MASK;
    interlock_model_run(last_ps);
}

struct interlock_nearness interlock_model_nearness(void)
{
    return near;
}

static uint32_t read(void *context, uintptr_t address)
{
    (void)context;
    return address == REG_INTERLOCK_FAULTS ? kept : causes(last_ps);
}

static void write(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    if (address == REG_INTERLOCK_CLEAR)
        kept &= ~value | causes(last_ps);
}

void interlock_model_start(const int32_t counts[4])
{
    static const struct {
        uintptr_t reg;
        uint32_t value;
    } at_reset[] = {
        {REG_INTERLOCK_WAY, REG_INTERLOCK_WAY_COUNTS_RESET},
        {REG_INTERLOCK_STRONG, REG_INTERLOCK_STRONG_VALUE_RESET},
        {REG_INTERLOCK_DRIVE_TIME, REG_INTERLOCK_DRIVE_TIME_VALUE_RESET},
        {REG_INTERLOCK_HELD_MOST, REG_INTERLOCK_HELD_MOST_VALUE_RESET},
        {REG_INTERLOCK_ILLEGAL_TIME, REG_INTERLOCK_ILLEGAL_TIME_VALUE_RESET},
    };

    kept = 0;
    last_ps = 0;
    window_ps = illegal_ps = WINDOW_PS;
    near = (struct interlock_nearness){0};
    for (unsigned n = 0; n < 4; n++) {
        off_ps[n] = -1;
        axes[n] = (struct axis){.count = counts[n], .lowest = counts[n], .highest = counts[n],
                                .window_count = counts[n], .strong_since = NEVER, .drive_since = NEVER};
        mmio_model_set(REG_INTERLOCK_STRONG_TIME0 + 4 * n, REG_INTERLOCK_STRONG_TIME0_VALUE_RESET);
        mmio_model_set(REG_INTERLOCK_BREAKAWAY0 + 4 * n, REG_INTERLOCK_BREAKAWAY0_VALUE_RESET);
        mmio_model_set(REG_INTERLOCK_SPEED_MOST0 + 4 * n, REG_INTERLOCK_SPEED_MOST0_VALUE_RESET);
    }
    for (unsigned n = 0; n < sizeof at_reset / sizeof at_reset[0]; n++)
        mmio_model_set(at_reset[n].reg, at_reset[n].value);
    mmio_model_hook((struct mmio_hook){
        .first = REG_INTERLOCK_FAULTS, .last = REG_INTERLOCK_CLEAR, .read = read, .write = write});
}
