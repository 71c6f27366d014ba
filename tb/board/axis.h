/* SPDX-License-Identifier: BSD-2-Clause */
/** One axis of the board model: brushed motor, lead screw with friction, encoder, limit switches. */
#ifndef BOARD_AXIS_H
#define BOARD_AXIS_H

#include <cstdint>

namespace plant {

/** As in plant.toml; the names are the same. */
struct AxisParameters {
    double pitch_mm;
    double counts_per_mm;
    double maximum_speed_mm_per_s;
    double free_speed_ratio;
    double speed_scale;
    double mechanical_time_constant_ms;
    double electrical_time_constant_ms;
    double breakaway_friction;
    double running_friction;
    double limit_lower_mm;
    double limit_upper_mm;
    double end_stop_mm;
    double start_counts;
    double index_counts;
};

/**
 * With torque and friction as fractions of stall torque, speed as the fraction w of the frictionless free speed,
 * and drive u as a fraction of the supply:
 *
 *     electrical time constant * dtorque/dt = u - w - torque
 *     mechanical time constant * dw/dt      = torque - friction
 *
 * Moving, friction is `running_friction` against the motion; at rest, the stage holds until the torque exceeds
 * `breakaway_friction`. Each step is the exact solution for a constant drive, except that a stage that would
 * reverse within a step stops at its end; so in no step does the stage move both ways.
 */
class Axis {
public:
    /** @throws std::invalid_argument, saying which parameter makes no sense. */
    Axis(const AxisParameters &parameters, double step_s);

    /** Move on by one plant step at a constant drive, -1..+1. */
    void step(double drive);

    /** Position and speed at `fraction` (0..1) of the last step. */
    double position_counts(double fraction) const;
    double speed_counts_per_s(double fraction) const;

    /** The fraction of the last step at which it crossed `edge`; only for edges between its ends. */
    double crossing(double edge) const;

    /** The count (floor of the position) at the end of the last step. */
    int64_t end_count() const;

    /** Z for a count: one count wide, once a turn. */
    bool index(int64_t count) const;

    /** Nothing moves and no torque is left: without drive, every step to come is like this one. */
    bool at_rest() const { return speed_ == 0.0 && torque_ == 0.0 && start_counts_ == end_counts_; }

    bool at_lower_limit() const { return end_counts_ <= lower_counts_; }
    bool at_upper_limit() const { return end_counts_ >= upper_counts_; }

private:
    void end_at(double counts);

    /* Constants. */
    double step_s_;
    double breakaway_, running_;
    double free_counts_per_step_; /* frictionless, at full drive */
    double torque_from_[4], speed_from_[4]; /* next torque and w from {torque, w, drive, friction} */
    double hold_decay_;                     /* of the torque at rest */
    double lower_counts_, upper_counts_, stop_counts_;
    int64_t turn_counts_, index_counts_;

    /* State: torque and w at the end of the last step. */
    double torque_ = 0.0, speed_ = 0.0;

    /* The last step: from start_counts_, with speeds at its ends in counts per step. */
    double start_counts_, end_counts_;
    double speed_before_ = 0.0, speed_after_ = 0.0;
};

} // namespace plant

#endif
