/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/bignum.h"

static void trim(struct bignum *number)
{
    while (number->used > 0 && number->limb[number->used - 1] == 0)
        number->used--;
}

void bignum_set(struct bignum *number, uint64_t value)
{
    number->limb[0] = (uint32_t)value;
    number->limb[1] = (uint32_t)(value >> 32);
    number->used = 2;
    trim(number);
}

unsigned bignum_bits(const struct bignum *number)
{
    if (number->used == 0)
        return 0;
    unsigned bits = (number->used - 1) * 32;

    for (uint32_t top = number->limb[number->used - 1]; top != 0; top >>= 1)
        bits++;
    return bits;
}

void bignum_multiply_add(struct bignum *number, uint32_t factor, uint32_t addend)
{
    uint32_t carry = addend;

    for (unsigned i = 0; i < number->used; i++) {
        uint32_t low = (number->limb[i] & 0xFFFFu) * factor + carry;
        uint32_t high = (number->limb[i] >> 16) * factor + (low >> 16);

        number->limb[i] = (high << 16) | (low & 0xFFFFu);
        carry = high >> 16;
    }
    if (carry != 0 && number->used < BIGNUM_LIMBS)
        number->limb[number->used++] = carry;
}

uint32_t bignum_divide_10000(struct bignum *number)
{
    uint32_t rest = 0;

    for (unsigned i = number->used; i-- > 0;) {
        uint32_t high = (rest << 16) | (number->limb[i] >> 16);
        uint32_t low = ((high % 10000u) << 16) | (number->limb[i] & 0xFFFFu);

        number->limb[i] = ((high / 10000u) << 16) | (low / 10000u);
        rest = low % 10000u;
    }
    trim(number);
    return rest;
}

void bignum_shift_left(struct bignum *number, unsigned bits)
{
    unsigned limbs = bits / 32, rest = bits % 32;

    if (number->used == 0 || number->used + limbs + 1 > BIGNUM_LIMBS)
        return;
    number->limb[number->used] = 0;
    for (unsigned i = number->used + 1; i-- > 0;) {
        uint32_t below = i > 0 && rest > 0 ? number->limb[i - 1] >> (32 - rest) : 0;

        number->limb[i + limbs] = (number->limb[i] << rest) | below;
    }
    for (unsigned i = 0; i < limbs; i++)
        number->limb[i] = 0;
    number->used += limbs + 1;
    trim(number);
}

static bool bit(const struct bignum *number, unsigned index)
{
    return index / 32 < number->used && (number->limb[index / 32] >> (index % 32) & 1u) != 0;
}

static bool any_bit_below(const struct bignum *number, unsigned index)
{
    for (unsigned i = 0; i < number->used && i * 32 < index; i++) {
        uint32_t limb = number->limb[i];

        if (index - i * 32 < 32)
            limb &= (1u << (index - i * 32)) - 1u;
        if (limb != 0)
            return true;
    }
    return false;
}

void bignum_shift_right_rounded(struct bignum *number, unsigned bits)
{
    if (bits == 0)
        return;
    bool half = bit(number, bits - 1), above = any_bit_below(number, bits - 1);
    bool up = half && (above || bit(number, bits));
    unsigned limbs = bits / 32, rest = bits % 32;

    if (limbs >= number->used) {
        number->used = 0;
    } else {
        number->used -= limbs;
        for (unsigned i = 0; i < number->used; i++) {
            uint32_t next = i + 1 < number->used ? number->limb[i + limbs + 1] : 0;

            number->limb[i] = number->limb[i + limbs] >> rest;
            if (rest > 0)
                number->limb[i] |= next << (32 - rest);
        }
        trim(number);
    }
    if (up && number->used == 0)
        bignum_set(number, 1);
    else if (up)
        bignum_multiply_add(number, 1, 1);
}

int bignum_compare(const struct bignum *a, const struct bignum *b)
{
    if (a->used != b->used)
        return a->used < b->used ? -1 : 1;
    for (unsigned i = a->used; i-- > 0;)
        if (a->limb[i] != b->limb[i])
            return a->limb[i] < b->limb[i] ? -1 : 1;
    return 0;
}

void bignum_subtract(struct bignum *a, const struct bignum *b)
{
    uint32_t borrow = 0;

    for (unsigned i = 0; i < a->used; i++) {
        uint32_t take = i < b->used ? b->limb[i] : 0;
        uint32_t part = a->limb[i] - take;

        uint32_t next = (a->limb[i] < take) || (part < borrow);
        a->limb[i] = part - borrow;
        borrow = next;
    }
    trim(a);
}
