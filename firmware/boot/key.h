/* SPDX-License-Identifier: BSD-2-Clause */
/** The public key that images must be signed with, as `imgtool getpub` writes it: DER with the key in its last bytes. */
#ifndef BOOT_KEY_H
#define BOOT_KEY_H

enum { KEY_DER_BYTES = 44, KEY_BYTES = 32 };

extern const unsigned char ed25519_pub_key[KEY_DER_BYTES];

#endif
