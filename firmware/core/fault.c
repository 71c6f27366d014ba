/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/fault.h"

#include <stdatomic.h>
#include <string.h>

#include "core/events.h"

enum { WAITING = 16 };

static uint16_t entries[FAULT_LOG];
static unsigned next; /* entry that will be written next */

/* Codes from interrupts on their way into the log; when it is full further ones are lost. */
static uint16_t waiting[WAITING];
static _Atomic uint32_t head, tail;

void log_error(uint16_t code)
{
    entries[next] = code;
    next = (next + 1) % FAULT_LOG;
    events_publish(EVENT_FAULT, code, events_now());
}

void log_error_from_interrupt(uint16_t code)
{
    uint32_t at = atomic_load_explicit(&head, memory_order_relaxed);

    if (at - atomic_load_explicit(&tail, memory_order_relaxed) == WAITING)
        return;
    waiting[at % WAITING] = code;
    atomic_signal_fence(memory_order_release);
    atomic_store_explicit(&head, at + 1u, memory_order_relaxed);
}

void fault_poll(void)
{
    uint32_t at = atomic_load_explicit(&tail, memory_order_relaxed);

    while (at != atomic_load_explicit(&head, memory_order_relaxed)) {
        atomic_signal_fence(memory_order_acquire);
        log_error(waiting[at % WAITING]);
        at++;
        atomic_store_explicit(&tail, at, memory_order_relaxed);
    }
}

uint16_t fault_read(unsigned entry)
{
    return entry < FAULT_LOG ? entries[(next + FAULT_LOG - 1 - entry) % FAULT_LOG] : FAULT_NONE;
}

void fault_clear(void)
{
    memset(entries, 0, sizeof entries);
}
