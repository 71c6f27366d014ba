/* SPDX-License-Identifier: BSD-2-Clause */
#include "processor.h"

extern "C" {
#include "host/interrupts.h"
}

namespace {

twin::Machine *bus;

} // namespace

void twin::processor_on(Machine &machine)
{
    bus = &machine;
}

extern "C" uint32_t mmio_read32(uintptr_t address)
{
    const uint32_t value = bus->read(uint32_t(address));
    host_interrupts_set_cycles(uint32_t(bus->now() / twin::SYNC));
    /* Where the main loop waits for the flash it is preempted as on the soft core: a file takes milliseconds to read. */
    if (address == REG_FLASH_STATUS) {
        host_interrupts_set(bus->interrupts());
        host_interrupts_serve();
    }
    return value;
}

extern "C" void mmio_write32(uintptr_t address, uint32_t value)
{
    bus->write(uint32_t(address), value);
    host_interrupts_set_cycles(uint32_t(bus->now() / twin::SYNC));
}
