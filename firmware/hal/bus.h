/* SPDX-License-Identifier: BSD-2-Clause */
/** Writes that no register or memory took; reads like that are exceptions. Always a bug. */
#ifndef HAL_BUS_H
#define HAL_BUS_H

#include <stdint.h>

/** Acknowledge the interrupt; where the write went. */
uint32_t bus_take_fault(void);

#endif
