/* SPDX-License-Identifier: BSD-2-Clause */
/** A 64-bit count of `sync` clocks and one alarm: rtl/timer.py. */
#ifndef TWIN_TIMER_H
#define TWIN_TIMER_H

#include <algorithm>

#include "block.h"

namespace twin {

class Timer final : public Block {
public:
    /** `init`: the count at reset. */
    Timer(Outputs &outputs, uint64_t init) : outputs_(outputs), init_(init) {}

    /** The count that `edge` sees. */
    uint64_t count(Time edge) const { return init_ + uint64_t(edge / SYNC); }

    uint32_t read(uint32_t address, Time edge) override
    {
        switch (address) {
        case REG_TIMER_COUNT: return uint32_t(count(edge));
        case REG_TIMER_LATCHED_LOW: return uint32_t(latched_);
        case REG_TIMER_LATCHED_HIGH: return uint32_t(latched_ >> 32);
        case REG_TIMER_ALARM: return alarm_;
        case REG_TIMER_STATUS: return armed_ ? REG_TIMER_STATUS_ARMED_MASK : 0;
        case REG_TIMER_INTERRUPT: return events_.bits;
        default: return 0;
        }
    }

    void write(uint32_t address, uint32_t value, Time edge) override
    {
        switch (address) {
        case REG_TIMER_CONTROL: command(value, edge); break;
        case REG_TIMER_ALARM: alarm_ = value; break;
        case REG_TIMER_INTERRUPT: events_.clear(edge, value); break;
        }
        plan(edge + SYNC);
        due = std::min(expires_, rings_);
        show(edge);
    }

    void run(Time edge) override
    {
        if (edge == rings_) {
            rings_ = NEVER;
            events_.set(edge, REG_TIMER_INTERRUPT_ALARM_MASK);
            show(edge);
        }
        if (edge == expires_) {
            expires_ = NEVER;
            armed_ = false;
            rings_ = edge + SYNC;
        }
        due = std::min(expires_, rings_);
    }

private:
    void command(uint32_t value, Time edge)
    {
        if (value & REG_TIMER_CONTROL_LATCH_MASK)
            latched_ = count(edge);
        if (value & REG_TIMER_CONTROL_ARM_MASK)
            armed_ = true;
        if (value & REG_TIMER_CONTROL_CANCEL_MASK) {
            armed_ = false;
            if (rings_ == edge + SYNC) /* it would have expired at this very edge */
                rings_ = NEVER;
        }
    }

    /** The first edge from `edge` on that sees the alarm reached. */
    void plan(Time edge)
    {
        const int32_t since = int32_t(uint32_t(count(edge)) - alarm_);
        expires_ = !armed_ ? NEVER : since >= 0 ? edge : edge - Time(since) * SYNC;
    }

    void show(Time edge) { outputs_.set(edge, INTERRUPT + INTERRUPT_TIMER, events_.bits != 0); }

    Outputs &outputs_;
    uint64_t init_, latched_ = 0;
    uint32_t alarm_ = 0;
    bool armed_ = false;
    Time expires_ = NEVER, rings_ = NEVER;
    EventBits events_;
};

} // namespace twin

#endif
