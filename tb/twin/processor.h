/* SPDX-License-Identifier: BSD-2-Clause */
/** The processor's bus: register accesses of the firmware go to one machine, and its cycles are that machine's time. */
#ifndef TWIN_PROCESSOR_H
#define TWIN_PROCESSOR_H

#include "machine.h"

namespace twin {

/** From now on registers are this machine's, which stays the caller's; before the firmware is started. */
void processor_on(Machine &machine);

} // namespace twin

#endif
