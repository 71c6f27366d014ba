/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Byte ring between one producer and one consumer, which may be an interrupt and the main loop.
 *
 * Neither side waits or locks: `head` is written by the producer only, `tail` by the consumer
 * only, both run freely and wrap at 2^32. The fences order the compiler, not the bus: both sides
 * run on one core. The size is a power of two; all of it is usable.
 */
#ifndef CORE_RING_H
#define CORE_RING_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct ring {
    uint8_t *bytes;
    uint32_t mask;         /* size - 1 */
    _Atomic uint32_t head; /* bytes ever put; producer only */
    _Atomic uint32_t tail; /* bytes ever taken; consumer only */
};

/** Define a static ring `name` of `size` bytes, a power of two. */
#define RING_DEFINE(name, size)                                                                    \
    _Static_assert((size) > 0 && ((size) & ((size) - 1)) == 0, "ring size: a power of two");       \
    static uint8_t name##_bytes[size];                                                             \
    static struct ring name = {.bytes = name##_bytes, .mask = (size) - 1}

/** Bytes waiting. Either side may ask; the answer can only grow (consumer) or shrink (producer). */
static inline uint32_t ring_used(const struct ring *ring)
{
    return atomic_load_explicit(&ring->head, memory_order_relaxed) -
           atomic_load_explicit(&ring->tail, memory_order_relaxed);
}

/** Room left, in bytes. */
static inline uint32_t ring_free(const struct ring *ring)
{
    return ring->mask + 1u - ring_used(ring);
}

/** Producer: append one byte. False, and nothing changed, when the ring is full. */
static inline bool ring_put(struct ring *ring, uint8_t byte)
{
    uint32_t head = atomic_load_explicit(&ring->head, memory_order_relaxed);

    if (ring_free(ring) == 0)
        return false;
    ring->bytes[head & ring->mask] = byte;
    atomic_signal_fence(memory_order_release);
    atomic_store_explicit(&ring->head, head + 1u, memory_order_relaxed);
    return true;
}

/** Consumer: take the oldest byte. False, and `byte` untouched, when the ring is empty. */
static inline bool ring_take(struct ring *ring, uint8_t *byte)
{
    uint32_t tail = atomic_load_explicit(&ring->tail, memory_order_relaxed);

    if (ring_used(ring) == 0)
        return false;
    atomic_signal_fence(memory_order_acquire);
    *byte = ring->bytes[tail & ring->mask];
    atomic_signal_fence(memory_order_release);
    atomic_store_explicit(&ring->tail, tail + 1u, memory_order_relaxed);
    return true;
}

/** Consumer: drop everything that waits. */
static inline void ring_clear(struct ring *ring)
{
    atomic_store_explicit(&ring->tail, atomic_load_explicit(&ring->head, memory_order_relaxed),
                          memory_order_relaxed);
}

#endif
