/* SPDX-License-Identifier: BSD-2-Clause */
/** The gateware this firmware runs on. */
#ifndef HAL_IDENTITY_H
#define HAL_IDENTITY_H

#include <stdbool.h>
#include <stdint.h>

/** Whether the registers are where, and mean what, this firmware was built for. */
bool identity_is_known(void);

/** Version of the register map the gateware has. */
uint32_t identity_map_version(void);

/** Name of the gateware build. */
uint32_t identity_build(void);

uint32_t identity_clock_rate_hz(void);
uint32_t identity_fast_clock_rate_hz(void);

#endif
