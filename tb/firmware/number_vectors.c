/* SPDX-License-Identifier: BSD-2-Clause */
#include "number_vectors.h"

#include <string.h>

#include "core/number.h"

/* splitmix64 (Steele, Lea, Flood 2014). */
static uint64_t next(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);

    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return z ^ z >> 31;
}

static uint32_t below(uint64_t *state, uint32_t limit)
{
    return (uint32_t)(next(state) >> 32) % limit;
}

static double from_parts(uint64_t sign, uint64_t exponent, uint64_t mantissa)
{
    uint64_t bits = sign << 63 | exponent << 52 | (mantissa & UINT64_C(0xFFFFFFFFFFFFF));
    double value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

double number_vector(uint64_t *state, unsigned *decimals)
{
    uint64_t random = next(state);

    *decimals = below(state, NUMBER_DECIMALS_MAX + 1);
    switch (below(state, 4)) {
    case 0: /* any finite double */
        return from_parts(random >> 63, random >> 52 & 0x7FF ? (random >> 52 & 0x7FF) - 1 : 0,
                          random);
    case 1: /* 2^-30 to 2^40: settings and positions */
        return from_parts(random >> 63, 1023 - 30 + random % 70, random >> 3);
    case 2: /* few bits: exact ties at some decimal */
        return from_parts(random >> 63, 1023 - 12 + random % 24,
                          random << 40 & UINT64_C(0xFF00000000000));
    default: { /* a decimal number as hosts send it */
        char text[24];
        size_t length = 0, used;
        double value = 0;

        for (unsigned digits = 1 + below(state, 9); digits > 0; digits--)
            text[length++] = (char)('0' + below(state, 10));
        text[length++] = '.';
        for (unsigned digits = below(state, 9); digits > 0; digits--)
            text[length++] = (char)('0' + below(state, 10));
        (void)number_parse(text, length, &value, &used);
        return random >> 63 != 0 ? -value : value;
    }
    }
}

static size_t digits(uint64_t *state, char *text, unsigned count)
{
    for (unsigned i = 0; i < count; i++)
        text[i] = (char)('0' + below(state, 10));
    return count;
}

void number_vector_text(uint64_t *state, char *text)
{
    size_t length = 0;

    if (below(state, 2) != 0)
        text[length++] = "+-"[below(state, 2)];
    length += digits(state, text + length, 1 + below(state, 30));
    if (below(state, 2) != 0) {
        text[length++] = '.';
        length += digits(state, text + length, below(state, 40));
    }
    if (below(state, 2) != 0) {
        text[length++] = "eE"[below(state, 2)];
        text[length++] = "+-"[below(state, 2)];
        length += digits(state, text + length, 1 + below(state, 3));
    }
    text[length] = '\0';
}

void number_each(uint32_t count, void (*take)(const char *text, size_t length, double read))
{
    uint64_t state = NUMBER_SEED;

    for (uint32_t i = 0; i < count; i++) {
        char text[NUMBER_TEXT_MAX], numeral[96];
        unsigned decimals;
        size_t used;
        double value = number_vector(&state, &decimals), read = 0;
        size_t length = number_format(text, value, decimals);

        number_vector_text(&state, numeral);
        (void)number_parse(numeral, strlen(numeral), &read, &used);
        take(text, length, read);
    }
}

static uint32_t hash;

static void fnv(const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ ((const uint8_t *)bytes)[i]) * 16777619u;
}

static void digest(const char *text, size_t length, double read)
{
    fnv(text, length);
    fnv(&read, sizeof read);
}

uint32_t number_digest(uint32_t count)
{
    hash = 2166136261u;
    number_each(count, digest);
    return hash;
}
