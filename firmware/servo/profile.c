/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/profile.h"

#include <math.h>

/* A plan in the making: a continuous motion, in ticks and counts, relative to the plan's start and
 * mirrored by `side`. */
struct sketch {
    struct profile_plan *plan;
    int64_t origin_q32;
    double side;
    double ticks, position, velocity; /* where the last stretch ended */
};

/* Mostly there is no jerk, and often no acceleration; a multiplication is 200 instructions. */
static double way(double velocity, double acceleration, double jerk, double t)
{
    double half = acceleration / 2.0;

    if (jerk != 0.0)
        half += t * (jerk * (1.0 / 6.0));
    return t * (half != 0.0 ? velocity + t * half : velocity);
}

static void advance(struct sketch *s, double acceleration, double jerk, double duration)
{
    s->position += way(s->velocity, acceleration, jerk, duration);
    if (jerk != 0.0)
        acceleration += duration * (jerk / 2.0);
    if (acceleration != 0.0)
        s->velocity += duration * acceleration;
}

/* A value along the motion with some fraction bits, in the direction of the counts. */
static int64_t fixed(const struct sketch *s, double value, int bits)
{
    return llround(ldexp(s->side < 0.0 ? -value : value, bits));
}

/* Longer than anything lasts, and what a plan's ticks add up to still fits: a way at 1e-99 counts a tick. */
static const double LAST_TICK = 0x1p62;

/* Add a stretch of motion, and sample it as a segment if at least one tick falls into it. */
static void stretch(struct sketch *s, double acceleration, double jerk, double duration)
{
    struct sketch at = *s;
    struct profile_segment *seg;
    double first = ceil(s->ticks), after, late = first - s->ticks;

    advance(s, acceleration, jerk, duration);
    s->ticks += duration;
    after = ceil(s->ticks);
    if (after <= first)
        return;
    advance(&at, acceleration, jerk, late);
    if (jerk != 0.0)
        acceleration += jerk * late;
    seg = &s->plan->segment[s->plan->segment_count++];
    seg->ticks = (uint64_t)fmin(after - first, LAST_TICK);
    seg->position_q32 = s->origin_q32 + fixed(s, at.position, 32);
    seg->step_q48 = fixed(s, at.velocity + (acceleration / 2.0 + jerk * (1.0 / 6.0)), 48);
    seg->change_q48 = fixed(s, acceleration + jerk, 48);
    seg->jerk_q48 = fixed(s, jerk, 48);
    /* A cruise is exact: the interrupt adds the upper 32 fraction bits of a step. */
    if (acceleration == 0.0 && jerk == 0.0)
        seg->step_q48 = fixed(s, at.velocity, 32) * 65536;
}

/* Bounds, and what is asked of them more than once. */
struct limits {
    double speed, acceleration, jerk_ticks;
    double ticks_per_speed; /* 1 / acceleration */
};

static struct limits limits_of(const struct profile_bounds *bounds)
{
    return (struct limits){bounds->speed, bounds->acceleration, bounds->jerk_ticks,
                           1.0 / bounds->acceleration};
}

/* Time of a change of speed, and its way: half of it at either speed, whatever the jerk. */
static double change_ticks(const struct limits *b, double difference)
{
    return difference == 0.0 ? 0.0 : fabs(difference) * b->ticks_per_speed + b->jerk_ticks;
}

static double change_way(const struct limits *b, double from, double to)
{
    return 0.5 * (from + to) * change_ticks(b, to - from);
}

/* Acceleration is a step convolved with a box of jerk_ticks: a trapezoid of two equal slopes. */
static void change_speed(struct sketch *s, const struct limits *b, double to)
{
    double difference = to - s->velocity;
    double ramp = fabs(difference) * b->ticks_per_speed;
    double slope = fmin(ramp, b->jerk_ticks), level = fmax(ramp, b->jerk_ticks);
    double acceleration;

    if (difference == 0.0)
        return;
    acceleration = level == ramp ? copysign(b->acceleration, difference) : difference / level;
    if (slope > 0.0)
        stretch(s, 0.0, acceleration / slope, slope);
    stretch(s, acceleration, 0.0, level - slope);
    if (slope > 0.0)
        stretch(s, acceleration, -acceleration / slope, slope);
    s->velocity = to;
}

/* Cruise speed of the motion from velocity u over a distance that suffices to brake from u. */
static double peak(const struct limits *b, double u, double distance)
{
    double c, root, p;

    /* Mostly the way is long enough for full speed. */
    if (u <= b->speed && change_way(b, u, b->speed) + change_way(b, b->speed, 0.0) <= distance)
        return b->speed;
    c = fmax(0.0, distance + u * (u / b->acceleration - b->jerk_ticks) / 2.0);
    root = sqrt(b->jerk_ticks * b->jerk_ticks + 4.0 * c / b->acceleration);
    p = root > 0.0 ? fmin(b->speed, 2.0 * c / (b->jerk_ticks + root)) : 0.0;

    /* Between the speeds it takes no change to keep, and those that the way is too short to reach. */
    if (b->jerk_ticks > 0.0 && u > 0.0 &&
        change_way(b, u, p) + change_way(b, p, 0.0) > distance + 1e-9 * (distance + u))
        p = u;
    return p;
}

void profile_plan_move(struct profile_plan *plan, const struct profile_point *start,
                       int64_t target_q32, const struct profile_bounds *bounds)
{
    double u = ldexp((double)start->velocity_q48, -48);
    double distance = ldexp((double)(target_q32 - start->position_q32), -32);
    struct limits limits = limits_of(bounds);
    double stop = change_way(&limits, u, 0.0), cruise_way, p;
    struct sketch s = {.plan = plan, .origin_q32 = start->position_q32};

    plan->segment_count = 0;
    plan->end_q32 = target_q32;
    if (start->velocity_q48 == 0 && target_q32 == start->position_q32)
        return;

    /* Mirror so that braking at once would stop short of the target: the motion then is change of
     * speed to a peak, cruise, brake, whatever the sign of u. */
    s.side = distance >= stop ? 1.0 : -1.0;
    distance *= s.side;
    u *= s.side;
    s.velocity = u;
    p = peak(&limits, u, distance);
    change_speed(&s, &limits, p);
    /* Rounding must not make a cruise of negative length. */
    cruise_way = distance - s.position - change_way(&limits, p, 0.0);
    if (p > 0.0 && cruise_way > 0.0)
        stretch(&s, 0.0, 0.0, cruise_way / p);
    change_speed(&s, &limits, 0.0);
}

int64_t profile_stop_q32(const struct profile_point *start, const struct profile_bounds *bounds)
{
    double u = ldexp((double)start->velocity_q48, -48);
    struct limits limits = limits_of(bounds);
    double counts = ldexp((double)start->position_q32, -32) + change_way(&limits, u, 0.0);

    if (u > 0.0)
        counts = ceil(counts);
    else if (u < 0.0)
        counts = floor(counts);
    else
        counts = floor(counts + 0.5);
    return (int64_t)counts * (INT64_C(1) << 32);
}

uint64_t profile_ticks(const struct profile_plan *plan)
{
    uint64_t ticks = 0;

    for (uint32_t i = 0; i < plan->segment_count; i++)
        ticks += plan->segment[i].ticks;
    return ticks;
}

/* Velocity at the tick that differences belong to: they are taken forward. */
static int64_t velocity_q48(int64_t step_q48, int64_t change_q48, int64_t jerk_q48)
{
    /* A division of 64 bits is a long one. */
    return step_q48 - change_q48 / 2 + (jerk_q48 != 0 ? jerk_q48 / 3 : 0);
}

static struct profile_point point_in(const struct profile_segment *seg, uint64_t ticks)
{
    double n = (double)ticks;
    double pairs = n * (n - 1.0) / 2.0;
    double change = (double)seg->change_q48, jerk = (double)seg->jerk_q48;

    /* Newton's series of the differences; the steps whole, as they can be large. */
    return (struct profile_point){
        .position_q32 = seg->position_q32 + (int64_t)ticks * (seg->step_q48 >> 16) +
                        (seg->change_q48 == 0 && seg->jerk_q48 == 0
                             ? 0
                             : llround((n * (double)(seg->step_q48 & 0xffff) + pairs * change +
                                        pairs * (n - 2.0) / 3.0 * jerk) / 65536.0)),
        .velocity_q48 = velocity_q48(seg->step_q48 + llround(n * change + pairs * jerk),
                                     seg->change_q48 + (int64_t)ticks * seg->jerk_q48,
                                     seg->jerk_q48),
    };
}

struct profile_point profile_at(const struct profile_plan *plan, uint64_t ticks)
{
    for (uint32_t i = 0; i < plan->segment_count; i++) {
        if (ticks < plan->segment[i].ticks)
            return point_in(&plan->segment[i], ticks);
        ticks -= plan->segment[i].ticks;
    }
    return (struct profile_point){.position_q32 = plan->end_q32};
}

struct profile_point profile_now(const struct profile_state *st)
{
    return (struct profile_point){
        .position_q32 = st->position_q32,
        .velocity_q48 = velocity_q48(st->step_q48, st->change_q48, st->jerk_q48),
    };
}

void profile_rest(struct profile_state *st, int64_t position_q32)
{
    *st = (struct profile_state){.position_q32 = position_q32};
}

static void enter(struct profile_state *st, uint32_t index)
{
    const struct profile_segment *seg;

    if (index >= st->plan->segment_count) {
        profile_rest(st, st->plan->end_q32);
        return;
    }
    seg = &st->plan->segment[index];
    st->index = index;
    st->ticks_left = (uint32_t)seg->ticks;
    st->ticks_left_high = (uint32_t)((seg->ticks - 1) >> 32);
    st->position_q32 = seg->position_q32;
    st->step_q48 = seg->step_q48;
    st->change_q48 = seg->change_q48;
    st->jerk_q48 = seg->jerk_q48;
}

void profile_begin(struct profile_state *st, const struct profile_plan *plan)
{
    st->plan = plan;
    enter(st, 0);
}

void profile_turn(struct profile_state *st)
{
    if (st->ticks_left_high == 0) {
        enter(st, st->index + 1);
        return;
    }
    st->ticks_left_high--;
    st->position_q32 += st->step_q48 >> 16;
    st->step_q48 += st->change_q48;
    st->change_q48 += st->jerk_q48;
}
