/* SPDX-License-Identifier: BSD-2-Clause */
/** Writes that nobody took: BusFaultPeripheral of soc/bus.py. */
#ifndef TWIN_BUS_FAULT_H
#define TWIN_BUS_FAULT_H

#include "block.h"

namespace twin {

class BusFault final : public Block {
public:
    explicit BusFault(Outputs &outputs) : outputs_(outputs) {}

    /** A write to `address` ends with a bus error at `edge`. */
    void refuse(uint32_t address, Time edge)
    {
        if (!fault_.bits)
            address_ = address & ~3u;
        fault_.set(edge, REG_BUS_FAULT_WRITE_MASK);
        show(edge);
    }

    uint32_t read(uint32_t address, Time) override
    {
        return address == REG_BUS_FAULT ? fault_.bits : address_;
    }

    void write(uint32_t address, uint32_t value, Time edge) override
    {
        if (address == REG_BUS_FAULT)
            fault_.clear(edge, value);
        show(edge);
    }

private:
    void show(Time edge) { outputs_.set(edge, INTERRUPT + INTERRUPT_BUS, fault_.bits != 0); }

    Outputs &outputs_;
    EventBits fault_;
    uint32_t address_ = 0;
};

} // namespace twin

#endif
