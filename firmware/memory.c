/* SPDX-License-Identifier: BSD-2-Clause */
/* memset and memcpy by words; the library's go by bytes. The target's only. */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A word that may stand for any other type. */
typedef uint32_t __attribute__((may_alias)) word;

enum { WORD = sizeof(word) };

void *memset(void *to, int value, size_t count)
{
    uint8_t *at = to, byte = (uint8_t)value;

    for (; count > 0 && (uintptr_t)at % WORD != 0; count--)
        *at++ = byte;
    for (; count >= WORD; count -= WORD, at += WORD)
        *(word *)at = byte * UINT32_C(0x01010101);
    for (; count > 0; count--)
        *at++ = byte;
    return to;
}

void *memcpy(void *restrict to, const void *restrict from, size_t count)
{
    uint8_t *at = to;
    const uint8_t *source = from;

    if (((uintptr_t)at | (uintptr_t)source) % WORD == 0)
        for (; count >= WORD; count -= WORD, at += WORD, source += WORD)
            *(word *)at = *(const word *)source;
    for (; count > 0; count--)
        *at++ = *source++;
    return to;
}
