/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/inputs.h"

#include <stddef.h>

#include "regs.h"

void inputs_read(struct inputs *inputs)
{
    uint32_t levels = inputs_levels_read();

    inputs->limit_lower =
        (levels & REG_INPUTS_LEVELS_LIMIT_LOWER_MASK) >> REG_INPUTS_LEVELS_LIMIT_LOWER_SHIFT;
    inputs->limit_upper =
        (levels & REG_INPUTS_LEVELS_LIMIT_UPPER_MASK) >> REG_INPUTS_LEVELS_LIMIT_UPPER_SHIFT;
    inputs->estop = (levels & REG_INPUTS_LEVELS_ESTOP_MASK) != 0;
    inputs->in0 = (levels & REG_INPUTS_LEVELS_IN0_MASK) != 0;
    inputs->in1 = (levels & REG_INPUTS_LEVELS_IN1_MASK) != 0;
}

bool inputs_take_edges(enum inputs_ttl pin, struct inputs_edges *edges, void (*rose)(void))
{
    static const struct {
        uint32_t rose, fell, level;
    } masks[INPUTS_TTL_COUNT] = {
        [INPUTS_IN0] = {REG_INPUTS_EDGES_IN0_ROSE_MASK, REG_INPUTS_EDGES_IN0_FELL_MASK,
                        REG_INPUTS_LEVELS_IN0_MASK},
        [INPUTS_IN1] = {REG_INPUTS_EDGES_IN1_ROSE_MASK, REG_INPUTS_EDGES_IN1_FELL_MASK,
                        REG_INPUTS_LEVELS_IN1_MASK},
    };
    const uint32_t seen = inputs_edges_read() & (masks[pin].rose | masks[pin].fell);

    if (seen == 0)
        return false;
    if (rose != NULL && (seen & masks[pin].rose) != 0)
        rose();
    /* Cleared first: an edge from here on is asked for again. */
    inputs_edges_write(seen);
    edges->rose = (seen & masks[pin].rose) != 0;
    edges->fell = (seen & masks[pin].fell) != 0;
    edges->level = (inputs_levels_read() & masks[pin].level) != 0;
    edges->at_cycles = pin == INPUTS_IN0 ? inputs_in0_time_read() : inputs_in1_time_read();
    return true;
}

bool inputs_in0_has_risen(void)
{
    return (inputs_edges_read() & REG_INPUTS_EDGES_IN0_ROSE_MASK) != 0;
}

uint32_t inputs_dip(void)
{
    return inputs_levels_dip_get();
}

uint32_t inputs_of_axis(unsigned axis)
{
    uint32_t levels = inputs_levels_read();

    return (levels >> (REG_INPUTS_LEVELS_LIMIT_LOWER_SHIFT + axis) & 1u ? INPUTS_LIMIT_LOWER : 0u) |
           (levels >> (REG_INPUTS_LEVELS_LIMIT_UPPER_SHIFT + axis) & 1u ? INPUTS_LIMIT_UPPER : 0u) |
           (levels & REG_INPUTS_LEVELS_ESTOP_MASK ? INPUTS_ESTOP : 0u);
}
