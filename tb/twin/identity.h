/* SPDX-License-Identifier: BSD-2-Clause */
/** Constants that name the gateware: rtl/identity.py. */
#ifndef TWIN_IDENTITY_H
#define TWIN_IDENTITY_H

#include "block.h"

namespace twin {

class Identity final : public Block {
public:
    explicit Identity(uint32_t build_id) : build_id_(build_id) {}

    uint32_t read(uint32_t address, Time) override
    {
        switch (address) {
        case REG_IDENTITY_MAGIC: return REG_MAGIC;
        case REG_IDENTITY_MAP_VERSION: return REG_MAP_VERSION;
        case REG_IDENTITY_BUILD_ID: return build_id_;
        case REG_IDENTITY_CLOCK_HZ: return CLOCK_HZ;
        case REG_IDENTITY_FAST_CLOCK_HZ: return FAST_CLOCK_HZ;
        default: return 0;
        }
    }

private:
    uint32_t build_id_;
};

} // namespace twin

#endif
