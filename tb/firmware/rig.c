/* SPDX-License-Identifier: BSD-2-Clause */
#include "rig.h"

#include <stddef.h>

#include "core/action.h"
#include "core/events.h"
#include "core/fault.h"
#include "core/module.h"
#include "host/mmio.h"
#include "modules/axis.h"
#include "modules/coordinates.h"
#include "modules/modules.h"
#include "modules/save_positions.h"
#include "port.h"
#include "regs.h"

void rig_start(void)
{
    axis_init();
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        coordinates_set_origin(axis, 0);
    save_positions_restore();
    events_set_clock(axis_time_fast);
    action_init(firmware_claims);
    port_start(firmware_modules);
}

void rig_latch(uint64_t time_fast, const int32_t position_counts[AXIS_COUNT])
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        mmio_model_set(REG_SNAPSHOT_TICK_POSITION0 + 4 * axis, (uint32_t)position_counts[axis]);
        mmio_model_set(REG_SNAPSHOT_SAMPLE_POSITION0 + 4 * axis, (uint32_t)position_counts[axis]);
    }
    mmio_model_set(REG_SNAPSHOT_TICK_TIME_LOW, (uint32_t)time_fast);
    mmio_model_set(REG_SNAPSHOT_TICK_TIME_HIGH, (uint32_t)(time_fast >> 32));
}

void rig_turn(void)
{
    fault_poll();
    events_poll();
    for (const struct module *const *module = firmware_modules; *module != NULL; module++)
        if ((*module)->poll != NULL)
            (*module)->poll();
}
