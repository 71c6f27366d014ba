/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * What verifying an Ed25519 signature takes of libsodium beside its files for the curve and the hashes, in the little
 * that is needed here: nothing is secret, nothing is signed, and 7 KiB of unrolled reduction are too many.
 */
#include <stdint.h>
#include <string.h>

#include "crypto_hash_sha512.h"
#include "private/ed25519_ref10.h"
#include "sign_ed25519_ref10.h"
#include "utils.h"

enum { WORDS = 8, HASH_BITS = 512 };

/* The order of the curve's base point, 2^252 + 27742317777372353535851937790883648493 (RFC 8032, 5.1), lowest word first. */
static const uint32_t order[WORDS] = {
    0x5cf5d3ed, 0x5812631a, 0xa2f79cd6, 0x14def9de, 0, 0, 0, 0x10000000,
};

/* result -= order, unless that is negative. */
static void subtract_order(uint32_t result[WORDS])
{
    uint32_t difference[WORDS];
    uint64_t borrow = 0;

    for (unsigned n = 0; n < WORDS; n++) {
        uint64_t word = (uint64_t)result[n] - order[n] - borrow;

        difference[n] = (uint32_t)word;
        borrow = word >> 63;
    }
    if (borrow == 0)
        memcpy(result, difference, sizeof difference);
}

/** The 512-bit number `s`, lowest byte first, modulo the order; bit by bit, in time that depends on it. */
void sc25519_reduce(unsigned char *s)
{
    uint32_t result[WORDS] = {0};

    for (unsigned bit = HASH_BITS; bit-- > 0;) {
        /* Below the order, which has 253 bits, so that there is room to double it. */
        for (unsigned n = WORDS; n-- > 1;)
            result[n] = result[n] << 1 | result[n - 1] >> 31;
        result[0] = result[0] << 1 | (s[bit / 8] >> bit % 8 & 1u);
        subtract_order(result);
    }
    memset(s, 0, HASH_BITS / 8);
    for (unsigned n = 0; n < WORDS * 4; n++)
        s[n] = (unsigned char)(result[n / 4] >> 8 * (n % 4));
}

/** Signatures over a message itself, not those over its hash (Ed25519ph), begin with nothing. */
void _crypto_sign_ed25519_ref10_hinit(crypto_hash_sha512_state *hs, int prehashed)
{
    (void)prehashed;
    crypto_hash_sha512_init(hs);
}

int sodium_memcmp(const void *const b1_, const void *const b2_, size_t len)
{
    return memcmp(b1_, b2_, len) == 0 ? 0 : -1;
}

int sodium_is_zero(const unsigned char *n, const size_t nlen)
{
    unsigned char any = 0;

    for (size_t i = 0; i < nlen; i++)
        any |= n[i];
    return any == 0;
}

void sodium_memzero(void *const pnt, const size_t len)
{
    memset(pnt, 0, len);
}
