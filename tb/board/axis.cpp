/* SPDX-License-Identifier: BSD-2-Clause */
#include "axis.h"

#include <cmath>
#include <stdexcept>

namespace plant {

namespace {

/* So little of stall torque that it changes no bit of what is added to it. */
constexpr double NO_TORQUE = 1e-30;

struct Matrix {
    double m[4][4];
};

Matrix multiply(const Matrix &a, const Matrix &b)
{
    Matrix product{};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++)
                product.m[i][j] += a.m[i][k] * b.m[k][j];
    return product;
}

/** exp(a) by its series after scaling: +, * and / only, so that every machine gets the same bits. */
Matrix exponential(Matrix a)
{
    constexpr int HALVINGS = 10, TERMS = 16;
    Matrix sum{}, term{};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            a.m[i][j] /= double(1 << HALVINGS);
    for (int i = 0; i < 4; i++)
        sum.m[i][i] = term.m[i][i] = 1.0;
    for (int n = 1; n <= TERMS; n++) {
        term = multiply(term, a);
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                sum.m[i][j] += term.m[i][j] /= n;
    }
    for (int n = 0; n < HALVINGS; n++)
        sum = multiply(sum, sum);
    return sum;
}

void require(bool sensible, const char *what)
{
    if (!sensible)
        throw std::invalid_argument(what);
}

void check(const AxisParameters &p)
{
    require(p.pitch_mm > 0 && p.counts_per_mm > 0, "expected pitch_mm and counts_per_mm above 0");
    require(p.maximum_speed_mm_per_s > 0 && p.free_speed_ratio > 0 && p.speed_scale > 0,
            "expected maximum_speed_mm_per_s, free_speed_ratio and speed_scale above 0");
    require(p.mechanical_time_constant_ms > 0 && p.electrical_time_constant_ms > 0,
            "expected electrical_time_constant_ms and mechanical_time_constant_ms above 0");
    require(p.running_friction >= 0 && p.running_friction <= p.breakaway_friction && p.running_friction < 1,
            "expected 0 <= running_friction <= breakaway_friction and running_friction < 1");
    require(p.limit_lower_mm < p.limit_upper_mm, "expected limit_lower_mm below limit_upper_mm");
    require(p.end_stop_mm >= 0, "expected end_stop_mm at least 0");
    require(p.end_stop_mm == 0 || std::fabs(p.start_counts) < p.end_stop_mm * p.counts_per_mm,
            "expected start_counts between the end stops");
}

} // namespace

Axis::Axis(const AxisParameters &p, double step_s)
    : step_s_(step_s), breakaway_(p.breakaway_friction), running_(p.running_friction)
{
    check(p);
    const double free_mm_per_s =
        p.maximum_speed_mm_per_s * p.free_speed_ratio * p.speed_scale / (1.0 - p.running_friction);
    free_counts_per_step_ = free_mm_per_s * p.counts_per_mm * step_s;

    /* State {torque, w} and the constant inputs {drive, friction}, solved together over one step. */
    const double electrical = step_s / (p.electrical_time_constant_ms * 1e-3);
    const double mechanical = step_s / (p.mechanical_time_constant_ms * 1e-3);
    const Matrix solution = exponential({{
        {-electrical, -electrical, electrical, 0.0},
        {mechanical, 0.0, 0.0, -mechanical},
        {0.0, 0.0, 0.0, 0.0},
        {0.0, 0.0, 0.0, 0.0},
    }});
    for (int i = 0; i < 4; i++) {
        torque_from_[i] = solution.m[0][i];
        speed_from_[i] = solution.m[1][i];
    }
    hold_decay_ = exponential({{{-electrical, 0, 0, 0}, {}, {}, {}}}).m[0][0];

    lower_counts_ = p.limit_lower_mm * p.counts_per_mm;
    upper_counts_ = p.limit_upper_mm * p.counts_per_mm;
    stop_counts_ = p.end_stop_mm * p.counts_per_mm;
    /* A line of the disc is four counts, and the index sits on one of them. */
    turn_counts_ = 4 * int64_t(std::floor(p.pitch_mm * p.counts_per_mm / 4.0 + 0.5));
    require(turn_counts_ > 0, "expected at least one encoder line per turn");
    index_counts_ = int64_t(std::floor(p.index_counts));
    start_counts_ = end_counts_ = p.start_counts;
}

void Axis::step(double drive)
{
    speed_before_ = speed_ * free_counts_per_step_;
    start_counts_ = end_counts_;

    if (speed_ == 0.0 && std::fabs(torque_) <= breakaway_) {
        torque_ = drive + (torque_ - drive) * hold_decay_;
        if (std::fabs(torque_) < NO_TORQUE)
            torque_ = 0.0;
        speed_after_ = 0.0;
        return;
    }
    const double direction = (speed_ != 0.0 ? speed_ : torque_) > 0.0 ? 1.0 : -1.0;
    const double input[4] = {torque_, speed_, drive, running_ * direction};
    torque_ = speed_ = 0.0;
    for (int i = 0; i < 4; i++) {
        torque_ += torque_from_[i] * input[i];
        speed_ += speed_from_[i] * input[i];
    }
    if (speed_ * direction < 0.0)
        speed_ = 0.0;
    speed_after_ = speed_ * free_counts_per_step_;
    end_counts_ = start_counts_ + 0.5 * (speed_before_ + speed_after_);

    if (stop_counts_ > 0.0 && std::fabs(end_counts_) > stop_counts_)
        end_at(end_counts_ > 0.0 ? stop_counts_ : -stop_counts_);
}

/** The hard stop: the rest of the way at an even speed, and there the speed is lost. */
void Axis::end_at(double counts)
{
    end_counts_ = counts;
    speed_before_ = speed_after_ = end_counts_ - start_counts_;
    speed_ = 0.0;
}

double Axis::position_counts(double fraction) const
{
    if (fraction >= 1.0)
        return end_counts_;
    return start_counts_ + fraction * (speed_before_ + 0.5 * fraction * (speed_after_ - speed_before_));
}

double Axis::speed_counts_per_s(double fraction) const
{
    return (speed_before_ + fraction * (speed_after_ - speed_before_)) / step_s_;
}

double Axis::crossing(double edge) const
{
    /* s * before + s^2/2 * (after - before) = distance; both speeds have one sign, and so does the root's
     * denominator: this form of the solution neither cancels nor divides by the acceleration. */
    const double distance = edge - start_counts_;
    const double discriminant = speed_before_ * speed_before_ + 2.0 * (speed_after_ - speed_before_) * distance;
    const double root = std::sqrt(discriminant > 0.0 ? discriminant : 0.0);
    const double denominator = speed_before_ + (end_counts_ >= start_counts_ ? root : -root);
    if (denominator == 0.0)
        return distance == 0.0 ? 0.0 : 1.0;
    const double fraction = 2.0 * distance / denominator;
    return fraction < 0.0 ? 0.0 : fraction > 1.0 ? 1.0 : fraction;
}

int64_t Axis::end_count() const
{
    return int64_t(std::floor(end_counts_));
}

bool Axis::index(int64_t count) const
{
    return (count - index_counts_) % turn_counts_ == 0;
}

} // namespace plant
