/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Registers for the host build: an array of words in place of the bus, and hooks where a model of a
 * peripheral wants to see accesses.
 *
 * Without a hook a register is plain memory, 0 at first. An access outside the register space, or
 * not to a whole word, prints where and aborts: on the target it would be a bus error.
 */
#ifndef HOST_MMIO_H
#define HOST_MMIO_H

#include <stdint.h>

enum { MMIO_HOOKS = 32 };

#define MMIO_FIRST 0xFFFFF000u
#define MMIO_WORDS 1024u

/**
 * A model of the registers `first` to `last` (addresses of words, both included).
 * A hook that is NULL leaves that direction plain memory.
 */
struct mmio_hook {
    uintptr_t first, last;
    uint32_t (*read)(void *context, uintptr_t address);
    void (*write)(void *context, uintptr_t address, uint32_t value);
    void *context;
};

/** All words 0, no hooks. */
void mmio_model_reset(void);

/** Later hooks win. Aborts when there are more than MMIO_HOOKS. */
void mmio_model_hook(struct mmio_hook hook);

/** The word itself, without hooks: the model's side of a register. */
uint32_t mmio_model_get(uintptr_t address);
void mmio_model_set(uintptr_t address, uint32_t value);

#endif
