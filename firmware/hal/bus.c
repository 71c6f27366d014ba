/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/bus.h"

#include "regs.h"

uint32_t bus_take_fault(void)
{
    uint32_t address = bus_address_read();

    bus_fault_write(REG_BUS_FAULT_WRITE_MASK);
    return address;
}
