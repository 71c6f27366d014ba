/* SPDX-License-Identifier: BSD-2-Clause */
#include "servo/profile.h"

#include <math.h>

static const double ONE_Q32 = 4294967296.0;

/* A stretch of the continuous motion, in ticks and counts, relative to the plan's start. */
struct stretch {
    double start_ticks;
    double position;
    double velocity;
    double acceleration;
};

static int64_t to_q32(double value)
{
    return (int64_t)llround(value * ONE_Q32);
}

/* Sample a stretch that ends at `end_ticks` as a segment, if at least one tick falls into it. */
static void sample(struct profile_plan *plan, int64_t origin_q32, const struct stretch *s,
                   double end_ticks)
{
    double first = ceil(s->start_ticks);
    double after = ceil(end_ticks);
    double late = first - s->start_ticks;
    struct profile_segment *seg;

    if (after <= first)
        return;
    seg = &plan->segment[plan->segment_count++];
    seg->ticks = (uint64_t)(after - first);
    seg->first.position_q32 =
        origin_q32 + to_q32(s->position + late * (s->velocity + 0.5 * s->acceleration * late));
    seg->first.velocity_q32 = to_q32(s->velocity + s->acceleration * late);
    seg->half_acceleration_q32 = to_q32(0.5 * s->acceleration);
}

void profile_plan_move(struct profile_plan *plan, const struct profile_point *start,
                       int64_t target_q32, double speed_per_tick,
                       double acceleration_per_tick2)
{
    double a = acceleration_per_tick2;
    double u = (double)start->velocity_q32 / ONE_Q32;
    double distance = (double)(target_q32 - start->position_q32) / ONE_Q32;
    double side = distance >= u * fabs(u) / (2.0 * a) ? 1.0 : -1.0;
    double peak, cruise_distance;
    struct stretch change, cruise, brake;
    double end_ticks;

    plan->segment_count = 0;
    plan->end_q32 = target_q32;
    if (start->velocity_q32 == 0 && target_q32 == start->position_q32)
        return;

    /* Mirror so that braking at once would stop short of the target: the motion then is change of
     * speed to a peak, cruise, brake, whatever the sign of u. */
    u *= side;
    distance *= side;
    peak = fmin(speed_per_tick, sqrt(fmax(0.0, a * distance + 0.5 * u * u)));
    if (u > speed_per_tick)
        peak = speed_per_tick;

    change.start_ticks = 0.0;
    change.position = 0.0;
    change.velocity = u;
    change.acceleration = u > peak ? -a : a;

    cruise.start_ticks = fabs(peak - u) / a;
    cruise.position = (peak * peak - u * u) / (2.0 * change.acceleration);
    cruise.velocity = peak;
    cruise.acceleration = 0.0;

    /* Rounding must not make a cruise of negative length. */
    cruise_distance = fmax(0.0, distance - cruise.position - peak * peak / (2.0 * a));
    brake.start_ticks = cruise.start_ticks + (peak > 0.0 ? cruise_distance / peak : 0.0);
    brake.position = cruise.position + cruise_distance;
    brake.velocity = peak;
    brake.acceleration = -a;
    end_ticks = brake.start_ticks + peak / a;

    change.velocity *= side;
    change.acceleration *= side;
    cruise.position *= side;
    cruise.velocity *= side;
    brake.position *= side;
    brake.velocity *= side;
    brake.acceleration *= side;
    sample(plan, start->position_q32, &change, cruise.start_ticks);
    sample(plan, start->position_q32, &cruise, brake.start_ticks);
    sample(plan, start->position_q32, &brake, end_ticks);
}

int64_t profile_stop_q32(const struct profile_point *start, double acceleration_per_tick2)
{
    double u = (double)start->velocity_q32 / ONE_Q32;
    double brake = u * fabs(u) / (2.0 * acceleration_per_tick2);
    double counts = (double)start->position_q32 / ONE_Q32 + brake;

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

struct profile_point profile_at(const struct profile_plan *plan, uint64_t ticks)
{
    struct profile_point point = { .position_q32 = plan->end_q32, .velocity_q32 = 0 };

    for (uint32_t i = 0; i < plan->segment_count; i++) {
        const struct profile_segment *seg = &plan->segment[i];

        if (ticks < seg->ticks) {
            int64_t n = (int64_t)ticks;

            /* The sum of what profile_tick adds, n times. */
            point.position_q32 = seg->first.position_q32 +
                n * (seg->first.velocity_q32 + n * seg->half_acceleration_q32);
            point.velocity_q32 = seg->first.velocity_q32 + 2 * n * seg->half_acceleration_q32;
            return point;
        }
        ticks -= seg->ticks;
    }
    return point;
}

void profile_rest(struct profile_state *st, int64_t position_q32)
{
    st->plan = 0;
    st->index = 0;
    st->ticks_left = 0;
    st->now.position_q32 = position_q32;
    st->now.velocity_q32 = 0;
    st->half_acceleration_q32 = 0;
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
    st->ticks_left = seg->ticks;
    st->now = seg->first;
    st->half_acceleration_q32 = seg->half_acceleration_q32;
}

void profile_begin(struct profile_state *st, const struct profile_plan *plan)
{
    st->plan = plan;
    enter(st, 0);
}

void profile_tick(struct profile_state *st)
{
    if (!st->plan)
        return;
    if (--st->ticks_left == 0) {
        enter(st, st->index + 1);
        return;
    }
    st->now.position_q32 += st->now.velocity_q32 + st->half_acceleration_q32;
    st->now.velocity_q32 += 2 * st->half_acceleration_q32;
}
