/* SPDX-License-Identifier: BSD-2-Clause */
#include "host/mmio.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/mmio.h"

static uint32_t words[MMIO_WORDS];
static struct mmio_hook hooks[MMIO_HOOKS];
static unsigned hook_count;

static uint32_t *word(uintptr_t address)
{
    if (address < MMIO_FIRST || address - MMIO_FIRST >= MMIO_WORDS * 4 || address % 4 != 0) {
        fprintf(stderr, "bus error at 0x%08lx\n", (unsigned long)address);
        abort();
    }
    return &words[(address - MMIO_FIRST) / 4];
}

static const struct mmio_hook *find(uintptr_t address)
{
    for (unsigned i = hook_count; i-- > 0;)
        if (address >= hooks[i].first && address <= hooks[i].last)
            return &hooks[i];
    return NULL;
}

uint32_t mmio_read32(uintptr_t address)
{
    const uint32_t *at = word(address);
    const struct mmio_hook *hook = find(address);

    return hook != NULL && hook->read != NULL ? hook->read(hook->context, address) : *at;
}

void mmio_write32(uintptr_t address, uint32_t value)
{
    uint32_t *at = word(address);
    const struct mmio_hook *hook = find(address);

    if (hook != NULL && hook->write != NULL)
        hook->write(hook->context, address, value);
    else
        *at = value;
}

void mmio_model_reset(void)
{
    memset(words, 0, sizeof words);
    hook_count = 0;
}

void mmio_model_hook(struct mmio_hook hook)
{
    if (hook_count == MMIO_HOOKS) {
        fprintf(stderr, "more than %d register hooks\n", MMIO_HOOKS);
        abort();
    }
    hooks[hook_count++] = hook;
}

uint32_t mmio_model_get(uintptr_t address)
{
    return *word(address);
}

void mmio_model_set(uintptr_t address, uint32_t value)
{
    *word(address) = value;
}
