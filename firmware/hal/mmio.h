/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The seam to hardware: every register access of the firmware is one of these two calls.
 *
 * On the target they are a single load and a single store. In the host build a model of the
 * peripherals provides them. Addresses are those of the target in both.
 */
#ifndef HAL_MMIO_H
#define HAL_MMIO_H

#include <stdint.h>

#ifdef __riscv

static inline uint32_t mmio_read32(uintptr_t address)
{
    return *(volatile const uint32_t *)address;
}

static inline void mmio_write32(uintptr_t address, uint32_t value)
{
    *(volatile uint32_t *)address = value;
}

#else

uint32_t mmio_read32(uintptr_t address);
void mmio_write32(uintptr_t address, uint32_t value);

#endif

#endif
