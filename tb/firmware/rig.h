/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * What machine.h, stage.h and closed_loop.h have in common: the whole firmware but its application.c, which
 * needs the interrupt lines, over memory for registers (host/mmio.h).
 */
#ifndef TB_FIRMWARE_RIG_H
#define TB_FIRMWARE_RIG_H

#include <stdint.h>

#include "core/axis.h"

/** Power up, as the registers are: axes at rest at 0, settings, all modules, a console (port.h). */
void rig_start(void);

/** What the snapshot has latched at a servo tick; positions in counts. */
void rig_latch(uint64_t time_fast, const int32_t position_counts[AXIS_COUNT]);

/** A turn of the main loop, without the console. */
void rig_turn(void);

#endif
