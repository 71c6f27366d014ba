/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/divider.h"

#include "regs.h"

void divider_load(const struct divider_line *line)
{
    divider_axis_write(line->axis);
    divider_whole_write(line->whole);
    divider_fraction_write(line->fraction);
    divider_phase_write(line->phase);
    divider_pixels_write(line->pixels);
    divider_width_write(line->width_fast);
    divider_interval_min_write(line->interval_min_fast);
    divider_config_write(line->emit ? REG_DIVIDER_CONFIG_EMIT_MASK : 0);
}

void divider_read(struct divider_result *result)
{
    uint32_t status = divider_status_read();

    result->refused = (status & REG_DIVIDER_STATUS_REFUSED_MASK) != 0;
    result->merged = (status & REG_DIVIDER_STATUS_MERGED_MASK) != 0;
    result->produced = divider_produced_read();
    result->merged_pixels = divider_merged_read();
    result->end_counts = divider_end_position_read();
}
