/* SPDX-License-Identifier: BSD-2-Clause */
/** Levels of the slow inputs, two `sync` flip-flops late: rtl/inputs.py. */
#ifndef TWIN_INPUTS_H
#define TWIN_INPUTS_H

#include "block.h"

namespace twin {

class Inputs final : public Block {
public:
    explicit Inputs(uint64_t pins) : levels_(gather(pins)) {}

    uint32_t read(uint32_t, Time edge) override { return levels_.before(edge); }

    void input(Time edge, uint64_t changed, uint64_t pins) override
    {
        if (changed & PINS)
            levels_.set(sync_from(edge) + SYNC, gather(pins));
    }

private:
    static constexpr uint64_t PINS =
        bit(ESTOP) | bit(IN0) | bit(IN1) | uint64_t(0xf) << LIMIT_LOWER | uint64_t(0xf) << LIMIT_UPPER;

    static uint32_t gather(uint64_t pins)
    {
        return uint32_t(pins >> LIMIT_LOWER & 0xf) << REG_INPUTS_LEVELS_LIMIT_LOWER_SHIFT |
               uint32_t(pins >> LIMIT_UPPER & 0xf) << REG_INPUTS_LEVELS_LIMIT_UPPER_SHIFT |
               uint32_t(pins >> ESTOP & 1) << REG_INPUTS_LEVELS_ESTOP_SHIFT |
               uint32_t(pins >> IN0 & 1) << REG_INPUTS_LEVELS_IN0_SHIFT |
               uint32_t(pins >> IN1 & 1) << REG_INPUTS_LEVELS_IN1_SHIFT;
    }

    Past<uint32_t> levels_;
};

} // namespace twin

#endif
