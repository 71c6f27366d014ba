/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The watchdog's registers: rtl/watchdog.py. Its clock is not modelled and nothing is reset: the firmware is a native program
 * here, which a reset of a processor cannot reach. Reset is remembered as the cause.
 */
#ifndef TWIN_WATCHDOG_H
#define TWIN_WATCHDOG_H

#include "block.h"

namespace twin {

class Watchdog final : public Block {
public:
    uint32_t read(uint32_t address, Time) override
    {
        switch (address) {
        case REG_WATCHDOG_TIMEOUT: return timeout_;
        case REG_WATCHDOG_STATUS:
            return cause_ | (running_ ? REG_WATCHDOG_STATUS_RUNNING_MASK : 0) | (cold_ ? REG_WATCHDOG_STATUS_COLD_MASK : 0);
        case REG_WATCHDOG_SCRATCH: return scratch_;
        default: return 0;
        }
    }

    void write(uint32_t address, uint32_t value, Time) override
    {
        switch (address) {
        case REG_WATCHDOG_CONTROL: running_ |= (value & REG_WATCHDOG_CONTROL_ENABLE_MASK) != 0; break;
        case REG_WATCHDOG_TIMEOUT: timeout_ = value; break;
        case REG_WATCHDOG_STATUS: cold_ &= (value & REG_WATCHDOG_STATUS_COLD_MASK) == 0; break;
        case REG_WATCHDOG_RESET:
            if (value == WATCHDOG_RESET_WORD) {
                cause_ = COMMAND;
                running_ = false;
            }
            break;
        case REG_WATCHDOG_SCRATCH: scratch_ = value; break;
        }
    }

private:
    static constexpr uint32_t COMMAND = 2;

    uint32_t timeout_ = REG_WATCHDOG_TIMEOUT_VALUE_RESET, scratch_ = 0, cause_ = 0;
    bool running_ = false, cold_ = true;
};

} // namespace twin

#endif
