/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/number.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "core/bignum.h"

/* IEEE 754 binary64. */
enum {
    MANTISSA_BITS = 52, /* stored; one more is implied */
    EXPONENT_BIAS = 1023,
    EXPONENT_SPECIAL = 2047,
    DECIMAL_EXPONENT_MAX = 310, /* 10^310 is above, */
    DECIMAL_EXPONENT_MIN = -310, /* 10^-310 below what a normal double can be */
};

_Static_assert(sizeof(double) == sizeof(uint64_t), "double is IEEE binary64");

/* A number as it stands in the text: digits * 10^exponent. */
struct decimal {
    bool negative;
    struct bignum digits;
    int exponent;
    int digit_count; /* significant ones */
    size_t used;
};

static bool is_digit(const char *text, size_t length, size_t at)
{
    return at < length && text[at] >= '0' && text[at] <= '9';
}

static void take_digit(struct decimal *decimal, char digit)
{
    if (decimal->digits.used > 0 || digit != '0')
        decimal->digit_count++;
    if (decimal->digit_count > NUMBER_DIGITS_MAX)
        return;
    if (decimal->digits.used > 0)
        bignum_multiply_add(&decimal->digits, 10, (uint32_t)(digit - '0'));
    else
        bignum_set(&decimal->digits, (uint64_t)(digit - '0'));
}

/* The exponent at `at`, if there is one; limited far outside what a double can be. */
static int take_exponent(struct decimal *decimal, const char *text, size_t length)
{
    size_t at = decimal->used;
    bool negative = false;
    int exponent = 0;

    if (at >= length || (text[at] != 'e' && text[at] != 'E'))
        return 0;
    at++;
    if (at < length && (text[at] == '+' || text[at] == '-'))
        negative = text[at++] == '-';
    if (!is_digit(text, length, at))
        return 0;
    for (; is_digit(text, length, at); at++)
        if (exponent < 100000)
            exponent = exponent * 10 + (text[at] - '0');
    decimal->used = at;
    return negative ? -exponent : exponent;
}

static bool read_decimal(struct decimal *decimal, const char *text, size_t length)
{
    size_t at = 0, digits = 0;

    memset(decimal, 0, sizeof *decimal);
    if (at < length && (text[at] == '+' || text[at] == '-'))
        decimal->negative = text[at++] == '-';
    for (; is_digit(text, length, at); at++, digits++)
        take_digit(decimal, text[at]);
    if (at < length && text[at] == '.') {
        at++;
        for (; is_digit(text, length, at); at++, digits++) {
            take_digit(decimal, text[at]);
            decimal->exponent--;
        }
    }
    if (digits == 0)
        return false;
    decimal->used = at;
    decimal->exponent += take_exponent(decimal, text, length);
    return true;
}

static void multiply_power_of_ten(struct bignum *number, int power)
{
    for (; power >= 4; power -= 4)
        bignum_multiply_add(number, 10000, 0);
    for (; power > 0; power--)
        bignum_multiply_add(number, 10, 0);
}

static double from_bits(uint64_t bits)
{
    double value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

/*
 * The double nearest to numerator / denominator, by long division: 53 bits of the quotient, one to
 * round with, and whether anything is left. False: too large.
 */
static bool divide(struct bignum *numerator, struct bignum *denominator, double *value)
{
    int exponent = (int)bignum_bits(numerator) - (int)bignum_bits(denominator);
    uint64_t quotient = 0;

    if (exponent > 0)
        bignum_shift_left(denominator, (unsigned)exponent);
    else
        bignum_shift_left(numerator, (unsigned)-exponent);
    if (bignum_compare(numerator, denominator) < 0) {
        bignum_shift_left(numerator, 1);
        exponent--;
    }

    /* Now 1 <= numerator / denominator < 2, and the value is that times 2^exponent. */
    int bits = MANTISSA_BITS + 2;

    for (; bits > 0 && numerator->used > 0; bits--) {
        quotient <<= 1;
        if (bignum_compare(numerator, denominator) >= 0) {
            bignum_subtract(numerator, denominator);
            quotient |= 1;
        }
        bignum_shift_left(numerator, 1);
    }
    quotient <<= bits;

    bool half = (quotient & 1) != 0, odd = (quotient & 2) != 0;
    quotient >>= 1;
    if (half && (odd || numerator->used > 0))
        quotient++;
    if (quotient >> (MANTISSA_BITS + 1) != 0) {
        quotient >>= 1;
        exponent++;
    }
    if (exponent > EXPONENT_BIAS)
        return false;
    if (exponent < 1 - EXPONENT_BIAS) {
        *value = 0;
        return true;
    }
    quotient &= (UINT64_C(1) << MANTISSA_BITS) - 1;
    *value = from_bits((uint64_t)(exponent + EXPONENT_BIAS) << MANTISSA_BITS | quotient);
    return true;
}

enum number_status number_parse(const char *text, size_t length, double *value, size_t *used)
{
    struct decimal decimal;
    struct bignum denominator;
    double magnitude;

    *used = 0;
    if (!read_decimal(&decimal, text, length))
        return NUMBER_NONE;
    *used = decimal.used;
    if (decimal.digit_count > NUMBER_DIGITS_MAX)
        return NUMBER_RANGE;

    /* Bounds that keep all powers of ten below 10^438, 1456 bits: inside a bignum. */
    int magnitude_exponent = decimal.digit_count + decimal.exponent;
    if (decimal.digits.used == 0 || magnitude_exponent < DECIMAL_EXPONENT_MIN) {
        *value = 0;
        return NUMBER_OK;
    }
    if (magnitude_exponent > DECIMAL_EXPONENT_MAX)
        return NUMBER_RANGE;

    bignum_set(&denominator, 1);
    if (decimal.exponent > 0)
        multiply_power_of_ten(&decimal.digits, decimal.exponent);
    else
        multiply_power_of_ten(&denominator, -decimal.exponent);
    if (!divide(&decimal.digits, &denominator, &magnitude))
        return NUMBER_RANGE;
    *value = decimal.negative && magnitude > 0 ? -magnitude : magnitude;
    return NUMBER_OK;
}

/* Decimal digits of a number, least significant first; at least `minimum` of them. */
static size_t digits_of(struct bignum *number, char *digits, size_t minimum, size_t maximum)
{
    size_t count = 0, significant = 0;

    while (number->used > 0 || count < minimum) {
        uint32_t part = bignum_divide_10000(number);

        for (int i = 0; i < 4; i++, part /= 10) {
            if (count >= maximum)
                return 0;
            digits[count++] = (char)('0' + part % 10);
            if (part % 10 != 0)
                significant = count;
        }
    }
    return significant > minimum ? significant : minimum;
}

size_t number_format(char *text, double value, unsigned decimals)
{
    uint64_t bits;
    struct bignum number;
    char digits[NUMBER_TEXT_MAX + 4];

    if (decimals > NUMBER_DECIMALS_MAX)
        return 0;
    memcpy(&bits, &value, sizeof bits);
    int exponent = (int)(bits >> MANTISSA_BITS & EXPONENT_SPECIAL);
    uint64_t mantissa = bits & ((UINT64_C(1) << MANTISSA_BITS) - 1);

    /* Anything from 2^128 up (and infinity and NaN) has too many digits. */
    if (exponent >= EXPONENT_BIAS + 128)
        return 0;
    if (exponent > 0)
        mantissa |= UINT64_C(1) << MANTISSA_BITS;
    else
        exponent = 1;
    exponent -= EXPONENT_BIAS + MANTISSA_BITS;

    /* value = mantissa * 2^exponent; number = value * 10^decimals, rounded. */
    bignum_set(&number, mantissa);
    multiply_power_of_ten(&number, (int)decimals);
    if (exponent > 0)
        bignum_shift_left(&number, (unsigned)exponent);
    else
        bignum_shift_right_rounded(&number, (unsigned)-exponent);

    bool negative = bits >> 63 != 0 && number.used > 0;
    size_t count = digits_of(&number, digits, decimals + 1, sizeof digits);
    size_t length = 0;

    if (count == 0 || count + (decimals > 0) + negative > NUMBER_TEXT_MAX)
        return 0;
    if (negative)
        text[length++] = '-';
    while (count > 0) {
        text[length++] = digits[--count];
        if (count == decimals && decimals > 0)
            text[length++] = '.';
    }
    return length;
}
