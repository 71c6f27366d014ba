/* SPDX-License-Identifier: BSD-2-Clause */
/** Levels of the slow inputs, two `sync` flip-flops late, and the edges of two of them: rtl/inputs.py. */
#ifndef TWIN_INPUTS_H
#define TWIN_INPUTS_H

#include "block.h"
#include "timer.h"

namespace twin {

class Inputs final : public Block {
public:
    Inputs(const Timer &timer, uint64_t pins) : timer_(timer), levels_(gather(pins))
    {
        listens = PINS;
        due = 0;
    }

    uint32_t read(uint32_t address, Time edge) override
    {
        switch (address) {
        case REG_INPUTS_LEVELS: return levels_.before(edge);
        case REG_INPUTS_EDGES: return edges_.bits;
        case REG_INPUTS_IN0_TIME: return time_[0];
        default: return time_[1];
        }
    }

    void write(uint32_t address, uint32_t value, Time edge) override
    {
        if (address == REG_INPUTS_EDGES)
            edges_.clear(edge, value);
    }

    void input(Time edge, uint64_t, uint64_t pins) override
    {
        levels_.set(sync_from(edge) + SYNC, gather(pins));
        seen_ = sync_from(edge) + 2 * SYNC;
        if (due == NEVER)
            due = seen_;
    }

    /** The first edge that sees new levels compares them with the last. */
    void run(Time edge) override
    {
        const uint32_t now = levels_.before(edge), changed = now ^ was_;
        watch(edge, 0, changed, now, REG_INPUTS_LEVELS_IN0_MASK, REG_INPUTS_EDGES_IN0_ROSE_MASK,
              REG_INPUTS_EDGES_IN0_FELL_MASK);
        watch(edge, 1, changed, now, REG_INPUTS_LEVELS_IN1_MASK, REG_INPUTS_EDGES_IN1_ROSE_MASK,
              REG_INPUTS_EDGES_IN1_FELL_MASK);
        was_ = now;
        due = edge < seen_ ? edge + SYNC : NEVER;
    }

private:
    static constexpr uint64_t PINS = bits(ESTOP, 1) | bits(IN0, 1) | bits(IN1, 1) | bits(LIMIT_LOWER, 4) |
                                     bits(LIMIT_UPPER, 4) | bits(DIP, 4);

    static uint32_t gather(uint64_t pins)
    {
        return uint32_t(pins >> LIMIT_LOWER & 0xf) << REG_INPUTS_LEVELS_LIMIT_LOWER_SHIFT |
               uint32_t(pins >> LIMIT_UPPER & 0xf) << REG_INPUTS_LEVELS_LIMIT_UPPER_SHIFT |
               uint32_t(pins >> ESTOP & 1) << REG_INPUTS_LEVELS_ESTOP_SHIFT |
               uint32_t(pins >> IN0 & 1) << REG_INPUTS_LEVELS_IN0_SHIFT |
               uint32_t(pins >> IN1 & 1) << REG_INPUTS_LEVELS_IN1_SHIFT |
               uint32_t(pins >> DIP & 0xf) << REG_INPUTS_LEVELS_DIP_SHIFT;
    }

    void watch(Time edge, unsigned n, uint32_t changed, uint32_t now, uint32_t level, uint32_t rose, uint32_t fell)
    {
        if (!(changed & level))
            return;
        edges_.set(edge, now & level ? rose : fell);
        time_[n] = uint32_t(timer_.count(edge));
    }

    const Timer &timer_;
    Past<uint32_t> levels_;
    uint32_t was_ = 0; /* at reset */
    Time seen_ = 0; /* the edge that sees the last change */
    EventBits edges_;
    uint32_t time_[2] = {};
};

} // namespace twin

#endif
