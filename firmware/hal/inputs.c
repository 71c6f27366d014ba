/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/inputs.h"

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
