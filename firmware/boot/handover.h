/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * What boot program and application tell each other in the watchdog's scratch word, which outlives a reset of the processor.
 *
 * Bits 31..16 say what it is, 15..8 the boot program's version, 7..0 the slot of the application that runs, plus 1.
 */
#ifndef BOOT_HANDOVER_H
#define BOOT_HANDOVER_H

#include <stdbool.h>
#include <stdint.h>

#define HANDOVER_STARTED 0xab5a0000u /* by the boot program */
#define HANDOVER_UPDATE 0xab0d0000u  /* by the application, which wants an update */
#define HANDOVER_KIND 0xffff0000u

static inline uint32_t handover_started(unsigned boot_version, int slot)
{
    return HANDOVER_STARTED | boot_version << 8 | (uint32_t)(slot + 1);
}

/** An application was started by a boot program of this project. */
static inline bool handover_is_started(uint32_t word)
{
    return (word & HANDOVER_KIND) == HANDOVER_STARTED;
}

static inline bool handover_is_update(uint32_t word)
{
    return (word & HANDOVER_KIND) == HANDOVER_UPDATE;
}

/** What an application leaves that wants an update: its own word, made a request. */
static inline uint32_t handover_update(uint32_t word)
{
    return HANDOVER_UPDATE | (word & 0xffffu);
}

static inline unsigned handover_boot_version(uint32_t word)
{
    return word >> 8 & 0xffu;
}

/** Slot of the application, -1 if it came with the bitstream. */
static inline int handover_slot(uint32_t word)
{
    return (int)(word & 0xffu) - 1;
}

#endif
