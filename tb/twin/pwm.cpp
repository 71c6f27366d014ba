/* SPDX-License-Identifier: BSD-2-Clause */
#include "pwm.h"

#include <algorithm>
#include <cstdlib>

namespace twin {

namespace {

constexpr int32_t PERIOD_CLOCKS = PWM_PERIOD_CLOCKS;
constexpr Time PERIOD = PERIOD_CLOCKS * SYNC;

} // namespace

Pwm::Pwm(Outputs &outputs, Snapshot &snapshot, Adc &adc, Interlock &interlock)
    : outputs_(outputs), snapshot_(snapshot), adc_(adc), interlock_(interlock), divider_(REG_PWM_TICK_DIVIDER_VALUE_RESET),
      delay_(REG_PWM_DUTY_DELAY_VALUE_RESET)
{
    agenda_.add(PERIOD - SYNC, Kind::START);
}

void Pwm::latched(Time edge)
{
    events_.set(edge, REG_PWM_INTERRUPT_TICK_MASK);
    show(edge);
}

uint32_t Pwm::read(uint32_t address, Time edge)
{
    switch (address) {
    case REG_PWM_CONTROL: return enable_;
    case REG_PWM_TICK_DIVIDER: return divider_;
    case REG_PWM_DUTY_DELAY: return delay_;
    case REG_PWM_INTERRUPT: return events_.bits;
    case REG_PWM_STATUS:
        return inhibit_.before(edge) << REG_PWM_STATUS_INHIBITED_SHIFT |
               uint32_t(outputs_.levels >> PWM & 0xf) << REG_PWM_STATUS_DRIVEN_SHIFT;
    default:
        return uint32_t(duty_[(address - REG_PWM_DUTY0) / 4 % AXES]) & REG_PWM_DUTY0_VALUE_MASK;
    }
}

void Pwm::write(uint32_t address, uint32_t value, Time edge)
{
    switch (address) {
    case REG_PWM_CONTROL:
        enable_ = value & REG_PWM_CONTROL_ENABLE_MASK;
        agenda_.add(edge + SYNC, Kind::OFF);
        break;
    case REG_PWM_TICK_DIVIDER:
        divider_ = value & REG_PWM_TICK_DIVIDER_VALUE_MASK;
        break;
    case REG_PWM_DUTY_DELAY:
        delay_ = value & REG_PWM_DUTY_DELAY_VALUE_MASK;
        break;
    case REG_PWM_INTERRUPT:
        events_.clear(edge, value);
        show(edge);
        break;
    case REG_PWM_STATUS:
        break;
    default: {
        constexpr uint32_t SIGN = 1u << (REG_PWM_DUTY0_VALUE_WIDTH - 1);
        duty_[(address - REG_PWM_DUTY0) / 4 % AXES] = int32_t(((value & REG_PWM_DUTY0_VALUE_MASK) ^ SIGN) - SIGN);
    }
    }
}

void Pwm::inhibit(uint32_t axes, Time edge)
{
    inhibit_.set(edge, axes);
    agenda_.add(edge + SYNC, Kind::OFF);
}

void Pwm::run(Time edge)
{
    while (agenda_.next() == edge) {
        const auto event = agenda_.take();
        switch (event.kind) {
        case Kind::START:
            start(edge);
            agenda_.add(edge + PERIOD, Kind::START);
            break;
        case Kind::TICK:
            if (events_.bits & REG_PWM_INTERRUPT_TICK_MASK)
                events_.set(edge, REG_PWM_INTERRUPT_OVERRUN_MASK);
            snapshot_.tick(edge);
            adc_.tick(edge);
            break;
        case Kind::OFF:
            switch_off(edge);
            break;
        case Kind::DRIVE:
            drive(edge);
            break;
        case Kind::FALL:
            outputs_.set(edge, PWM + unsigned(event.value), false);
            break;
        }
    }
}

void Pwm::start(Time edge)
{
    const bool due = left_ == 0 && divider_ != 0, stopped = left_ == 0 && divider_ == 0;
    const bool take = stopped || (waiting_ && (wait_ == 0 || due));

    if (due) {
        left_ = uint8_t(divider_ - 1);
        wait_ = uint8_t(delay_ - 1);
        waiting_ = true;
        agenda_.add(edge + SYNC, Kind::TICK);
    } else {
        wait_--;
        if (left_ != 0)
            left_--;
        if (take)
            waiting_ = false;
    }

    bool moves = false;
    for (unsigned axis = 0; axis < AXES; axis++) {
        if (take)
            taken_[axis] = duty_[axis];
        if (off(axis, edge)) {
            taken_[axis] = on_[axis] = 0;
        } else {
            on_[axis] = std::min(std::abs(taken_[axis]), PERIOD_CLOCKS);
            direction_[axis] = taken_[axis] > 0;
        }
        interlock_.drive(axis, direction_[axis] ? on_[axis] : -on_[axis], edge);
        moves |= on_[axis] != 0 || (outputs_.levels >> (PWM + axis) & 1) ||
                 direction_[axis] != bool(outputs_.levels >> (DIR + axis) & 1);
    }
    if (moves)
        agenda_.add(edge + SYNC, Kind::DRIVE);
}

/** The pins follow the duties of a period one clock after its start. */
void Pwm::drive(Time edge)
{
    for (unsigned axis = 0; axis < AXES; axis++) {
        const bool on = on_[axis] != 0 && !off(axis, edge);
        outputs_.set(edge, DIR + axis, direction_[axis]);
        outputs_.set(edge, PWM + axis, on);
        if (on && on_[axis] != PERIOD_CLOCKS)
            agenda_.add(edge + on_[axis] * SYNC, Kind::FALL, axis);
    }
}

void Pwm::switch_off(Time edge)
{
    for (unsigned axis = 0; axis < AXES; axis++) {
        if (!off(axis, edge))
            continue;
        taken_[axis] = on_[axis] = 0;
        outputs_.set(edge, PWM + axis, false);
        interlock_.drive(axis, 0, edge);
    }
    outputs_.set(edge, MOTOR_ENABLE, (enable_ & ~inhibit_.before(edge)) != 0);
}

void Pwm::show(Time edge)
{
    outputs_.set(edge, INTERRUPT + INTERRUPT_TICK, (events_.bits & REG_PWM_INTERRUPT_TICK_MASK) != 0);
}

} // namespace twin
