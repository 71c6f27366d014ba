/* SPDX-License-Identifier: BSD-2-Clause */
#include "processor.h"

#include <csetjmp>

extern "C" {
#include "boot/boot.h"
#include "hal/mmio.h"
#include "host/interrupts.h"
}

namespace {

constexpr twin::Time RESET = 32 * twin::SYNC; /* within which an ordered reset comes */

twin::Machine *bus;
void (*pace_of_program)();
bool runs;
std::jmp_buf ended;

void leave(twin::Ended how)
{
    if (runs)
        std::longjmp(ended, int(how) + 1);
}

void accessed()
{
    host_interrupts_set_cycles(uint32_t(bus->now() / twin::SYNC));
    if (bus->has_reset())
        leave(twin::Ended::RESET);
    if (pace_of_program)
        pace_of_program();
}

} // namespace

void twin::processor_on(Machine &machine)
{
    bus = &machine;
}

twin::Ended twin::processor_run(void (*program)(), void (*pace)())
{
    const int how = setjmp(ended);

    if (how == 0) {
        runs = true;
        pace_of_program = pace;
        program();
    }
    runs = false;
    pace_of_program = nullptr;
    return how == 0 ? Ended::RETURNED : Ended(how - 1);
}

extern "C" uint32_t mmio_read32(uintptr_t address)
{
    const uint32_t value = bus->read(uint32_t(address));
    accessed();
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
    if (address == REG_WATCHDOG_RESET)
        bus->advance(bus->now() + RESET);
    accessed();
}

/* There is one program that the boot program runs, whatever image it has verified: the application in this machine's code. */
extern "C" void boot_run(uint32_t)
{
    leave(twin::Ended::RUNS_ANOTHER);
}
