/* SPDX-License-Identifier: BSD-2-Clause */
/** The time since the last kick, and what is kept over a reset of the processor: rtl/watchdog.py. */
#ifndef TWIN_WATCHDOG_H
#define TWIN_WATCHDOG_H

#include <algorithm>

#include "block.h"
#include "interlock.h"

namespace twin {

class Watchdog final : public Block {
public:
    explicit Watchdog(Interlock &interlock) : interlock_(interlock) {}

    /** The processor has been reset since it last started. */
    bool has_reset() const { return reset_; }
    void start() { reset_ = false; }

    uint32_t read(uint32_t address, Time) override
    {
        switch (address) {
        case REG_WATCHDOG_TIMEOUT: return timeout_;
        case REG_WATCHDOG_STATUS:
            return cause_ << REG_WATCHDOG_STATUS_CAUSE_SHIFT | (running_ ? REG_WATCHDOG_STATUS_RUNNING_MASK : 0) |
                   cold_;
        case REG_WATCHDOG_SCRATCH: return scratch_;
        default: return 0;
        }
    }

    void write(uint32_t address, uint32_t value, Time edge) override
    {
        const bool resetting = edge >= expired_ && edge < expired_ + LENGTH;
        switch (address) {
        case REG_WATCHDOG_CONTROL:
            if (!(value & REG_WATCHDOG_CONTROL_ENABLE_MASK) || resetting)
                break;
            if (!running_)
                kick(edge);
            running_ = true;
            break;
        case REG_WATCHDOG_TIMEOUT: timeout_ = value; break;
        case REG_WATCHDOG_KICK:
            if (value == WATCHDOG_KICK_WORD && !resetting)
                kick(edge);
            break;
        case REG_WATCHDOG_STATUS: cold_ &= ~value; break;
        case REG_WATCHDOG_RESET:
            if (value == WATCHDOG_RESET_WORD && !resetting)
                expire(edge, COMMAND);
            break;
        case REG_WATCHDOG_SCRATCH: scratch_ = value; break;
        }
        plan();
    }

    void run(Time edge) override
    {
        if (edge == stops_) {
            running_ = false;
            reset_ = true;
            stops_ = NEVER;
        } else {
            expire(edge, EXPIRED);
        }
        plan();
    }

private:
    enum Cause : uint32_t { POWER_UP, EXPIRED, COMMAND };
    /* From `expired` to the reset, and to the clock after its end. */
    static constexpr Time DRIVES_OFF = 8 * SYNC, LENGTH = (8 + 16 + 1) * SYNC;

    void kick(Time edge) { late_ = edge + (Time(timeout_) + 1) * SYNC; }

    void expire(Time edge, Cause cause)
    {
        cause_ = cause;
        expired_ = edge;
        stops_ = edge + DRIVES_OFF;
        interlock_.expired(edge);
    }

    void plan() { due = std::min(stops_, running_ && stops_ == NEVER ? late_ : NEVER); }

    Interlock &interlock_;
    uint32_t timeout_ = REG_WATCHDOG_TIMEOUT_VALUE_RESET, scratch_ = 0, cause_ = POWER_UP;
    uint32_t cold_ = REG_WATCHDOG_STATUS_COLD_MASK;
    bool running_ = false, reset_ = false;
    Time late_ = NEVER;            /* the edge that finds no kick in time */
    Time expired_ = -2 * LENGTH;   /* the last one that did */
    Time stops_ = NEVER;           /* the processor's reset begins */
};

} // namespace twin

#endif
