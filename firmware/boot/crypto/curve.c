/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * libsodium's arithmetic of the curve, with squares by its multiplication, which halves its size and takes a third more
 * time. Its reduction of scalars is replaced by that of sodium.c.
 */
#include "private/ed25519_ref10.h"

/* 2 f^2: its f has at most 1.1 * 2^25 in a limb, so 2 f is in the range of the multiplication, 1.65 * 2^26. */
static inline void fe25519_twice_square(fe25519 h, const fe25519 f)
{
    fe25519 twice;

    fe25519_add(twice, f, f);
    fe25519_mul(h, f, twice);
}

#define fe25519_sq(h, f) fe25519_mul(h, f, f)
#define fe25519_sq2(h, f) fe25519_twice_square(h, f)
#define sc25519_reduce sc25519_reduce_unrolled

#include "crypto_core/ed25519/ref10/ed25519_ref10.c"
