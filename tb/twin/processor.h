/* SPDX-License-Identifier: BSD-2-Clause */
/** The processor's bus: register accesses of the firmware go to one machine, and its cycles are that machine's time. */
#ifndef TWIN_PROCESSOR_H
#define TWIN_PROCESSOR_H

#include "machine.h"

namespace twin {

/** From now on registers are this machine's, which stays the caller's; before the firmware is started. */
void processor_on(Machine &machine);

/** How a program came to its end. */
enum class Ended { RETURNED, RUNS_ANOTHER, RESET };

/**
 * Run a program until it returns, calls boot_run (firmware/boot/boot.h), or the processor is reset. It is left where it
 * stands: in a register access, which waits for `pace` after it, if there is one.
 */
Ended processor_run(void (*program)(), void (*pace)() = nullptr);

} // namespace twin

#endif
