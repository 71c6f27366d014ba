/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/knob.h"

#include "regs.h"

int16_t knob_position(enum knob knob)
{
    return (int16_t)knob_position_read(knob);
}
