/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/router.h"

#include "regs.h"

void router_select(enum router_pin pin, enum router_source source, bool invert)
{
    uint32_t value = (uint32_t)source << REG_ROUTER_OUT0_SOURCE_SHIFT;

    if (invert)
        value |= REG_ROUTER_OUT0_INVERT_MASK;
    switch (pin) {
    case ROUTER_OUT0:
        router_out0_write(value);
        break;
    case ROUTER_SYNC:
        router_sync_write(value);
        break;
    case ROUTER_ENCODER:
        router_encoder_write(value);
        break;
    }
}
