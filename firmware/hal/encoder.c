/* SPDX-License-Identifier: BSD-2-Clause */
#include "hal/encoder.h"

#include "regs.h"

void encoder_configure(unsigned axis, unsigned filter_samples, bool invert)
{
    uint32_t config = (filter_samples << REG_QUADRATURE_CONFIG_FILTER_SHIFT) &
                      REG_QUADRATURE_CONFIG_FILTER_MASK;

    if (invert)
        config |= REG_QUADRATURE_CONFIG_INVERT_MASK;
    quadrature_config_write(axis, config);
}

uint32_t encoder_errors(unsigned axis)
{
    return quadrature_errors_read(axis);
}
