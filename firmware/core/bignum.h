/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Unsigned integers of up to BIGNUM_LIMBS * 32 bits, just what exact number conversion needs.
 * Results that do not fit are the caller's error; number.c shows its bounds where it calls.
 */
#ifndef CORE_BIGNUM_H
#define CORE_BIGNUM_H

#include <stdbool.h>
#include <stdint.h>

enum { BIGNUM_LIMBS = 48 };

struct bignum {
    unsigned used; /* limbs; the topmost is not 0; 0 limbs: the value 0 */
    uint32_t limb[BIGNUM_LIMBS]; /* least significant first */
};

void bignum_set(struct bignum *number, uint64_t value);
unsigned bignum_bits(const struct bignum *number);
/** number = number * factor + addend, both below 2^16 (no 64-bit arithmetic on the target). */
void bignum_multiply_add(struct bignum *number, uint32_t factor, uint32_t addend);
/** number = number / 10000; returns the remainder. */
uint32_t bignum_divide_10000(struct bignum *number);
void bignum_shift_left(struct bignum *number, unsigned bits);
/** Divides by 2^bits and rounds to nearest, ties to even. */
void bignum_shift_right_rounded(struct bignum *number, unsigned bits);
/** -1, 0, 1 as a < b, a == b, a > b. */
int bignum_compare(const struct bignum *a, const struct bignum *b);
/** a = a - b; a >= b. */
void bignum_subtract(struct bignum *a, const struct bignum *b);

#endif
