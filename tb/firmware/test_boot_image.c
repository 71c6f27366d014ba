/* SPDX-License-Identifier: BSD-2-Clause */
/* boot/image: images made by imgtool, whole and spoilt; the signatures of RFC 8032; SHA-2 as the library has it. */
#include "boot/image.h"

#include "boot/slot.h"
#include "boot_images.h"
#include "check.h"
#include "image_file.h"
#include "crypto_hash_sha256.h"
#include "crypto_hash_sha512.h"
#include "crypto_sign_ed25519.h"
#include "nor_flash.h"
#include "random.h"

/* Ours, and libsodium's own, which boot/crypto/curve.c puts aside. */
void sc25519_reduce(unsigned char *s);
void sc25519_reduce_unrolled(unsigned char *s);

static struct image image;

static enum image_verdict load(void)
{
    return image_load(slot_address(0), SLOT_IMAGE_BYTES, 0, boot_memory, &image);
}

static enum image_verdict verdict_of(const char *name)
{
    memset(boot_memory, 0, IMAGE_START_BYTES);
    nor_flash_reset();
    boot_image_put(name, 0);
    return load();
}

/* What was refused is not to be taken for an application. */
#define EXPECT(name, verdict)                                                                      \
    do {                                                                                           \
        CHECK_TEXT(image_verdict_text(verdict_of(name)), image_verdict_text(verdict));             \
        CHECK_INT(image_is_application(boot_memory), verdict == IMAGE_VALID);                      \
    } while (0)

TEST(takes_what_imgtool_signs)
{
    static uint8_t file[IMAGE_FILE_BYTES];

    EXPECT("good", IMAGE_VALID);
    image_file_read("good", file);
    CHECK_INT(image.loaded_bytes, 32 + 8000);
    CHECK(memcmp(boot_memory, file, image.loaded_bytes) == 0);
    CHECK_INT(image.version.major, 1);
    CHECK_INT(image.hash_bytes, 32);
    EXPECT("newer", IMAGE_VALID);
    CHECK_INT(image_counter(&image.version), 0x01000001);
    CHECK_INT(image.version.build, 7);
    EXPECT("sha512", IMAGE_VALID);
    CHECK_INT(image.hash_bytes, 64);
    EXPECT("full-key", IMAGE_VALID);
    EXPECT("protected", IMAGE_VALID);
    EXPECT("largest", IMAGE_VALID);
    CHECK_INT(image.loaded_bytes, IMAGE_RAM_BYTES);
}

TEST(says_why_it_refuses)
{
    nor_flash_reset();
    CHECK_INT(load(), IMAGE_NONE);
    EXPECT("too-large", IMAGE_TOO_LARGE);
    EXPECT("unsigned", IMAGE_UNSIGNED);
    EXPECT("other-key", IMAGE_OTHER_KEY);
    EXPECT("forged", IMAGE_WRONG_SIGNATURE);
    EXPECT("other-product", IMAGE_OTHER_PRODUCT);
    EXPECT("other-mark", IMAGE_OTHER_PRODUCT);
    EXPECT("other-gateware", IMAGE_OTHER_GATEWARE);
    EXPECT("elsewhere", IMAGE_ELSEWHERE);
    EXPECT("not-bootable", IMAGE_BAD_HEADER);
    EXPECT("pure", IMAGE_WRONG_SIGNATURE);
}

TEST(refuses_what_is_older_than_allowed)
{
    nor_flash_reset();
    boot_image_put("newer", 0); /* 1.0.1 */
    CHECK_INT(image_load(slot_address(0), SLOT_IMAGE_BYTES, 0x01000001, boot_memory, &image), IMAGE_VALID);
    CHECK_INT(image_load(slot_address(0), SLOT_IMAGE_BYTES, 0x01000002, boot_memory, &image), IMAGE_OLDER);
}

TEST(refuses_a_file_that_ends_early)
{
    static uint8_t file[IMAGE_FILE_BYTES];
    const size_t size = image_file_read("good", file);

    nor_flash_reset();
    boot_image_put("good", 0);
    CHECK_INT(image_load(slot_address(0), (uint32_t)size, 0, boot_memory, &image), IMAGE_VALID);
    for (uint32_t less = 1; less < size; less++) {
        const uint32_t room = (uint32_t)size - less;
        const enum image_verdict verdict = image_load(slot_address(0), room, 0, boot_memory, &image);

        CHECK(verdict == IMAGE_TRUNCATED || (room < IMAGE_START_BYTES && verdict == IMAGE_UNREADABLE));
    }
}

/* Every bit of header, first words and TLVs, and bits all over the program. */
TEST(notices_every_wrong_bit)
{
    static const char *const names[] = {"good", "protected", "sha512", "full-key"};
    static uint8_t file[IMAGE_FILE_BYTES];

    for (unsigned n = 0; n < sizeof names / sizeof *names; n++) {
        const size_t size = image_file_read(names[n], file);

        nor_flash_reset();
        boot_image_put(names[n], 0);
        for (uint32_t at = 0; at < size; at += at < 60 || at > 8032 - 97 ? 1 : 97) {
            const uint8_t bit = (uint8_t)(1u << random_below(8));

            nor_flash[slot_address(0) + at] ^= bit;
            if (load() == IMAGE_VALID)
                CHECK_FAIL("%s: bit %#x of byte %u may be wrong", names[n], bit, (unsigned)at);
            nor_flash[slot_address(0) + at] ^= bit;
        }
        CHECK_INT(load(), IMAGE_VALID);
    }
}

/* --- the library -------------------------------------------------------------------------------------------- */

static size_t from_hex(const char *text, uint8_t *bytes)
{
    size_t count = 0;
    unsigned value;

    for (; sscanf(text, "%2x", &value) == 1; text += 2)
        bytes[count++] = (uint8_t)value;
    return count;
}

/* RFC 8032, 7.1, tests 1, 2 and 3: public key, message, signature. */
TEST(verifies_the_signatures_of_rfc_8032)
{
    static const char *const vectors[][3] = {
        {"d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a", "",
         "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e06522490155"
         "5fb8821590a33bacc61e39701cf9b46bd25bf5f0595bbe24655141438e7a100b"},
        {"3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c", "72",
         "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da"
         "085ac1e43e15996e458f3613d0f11d8c387b2eaeb4302aeeb00d291612bb0c00"},
        {"fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025", "af82",
         "6291d657deec24024827e69c3abe01a30ce548a284743a445e3680d7db5ac3ac"
         "18ff9b538d16f290ae67f760984dc6594a7c15e9716ed28dc027beceea1ec40a"},
    };

    for (unsigned n = 0; n < 3; n++) {
        uint8_t key[32], message[64], signature[64];
        const size_t size = from_hex(vectors[n][1], message);

        CHECK_INT(from_hex(vectors[n][0], key), 32);
        CHECK_INT(from_hex(vectors[n][2], signature), 64);
        CHECK_INT(crypto_sign_ed25519_verify_detached(signature, message, size, key), 0);
        for (unsigned bit = 0; bit < 512; bit += 7) {
            signature[bit / 8] ^= (uint8_t)(1u << bit % 8);
            CHECK(crypto_sign_ed25519_verify_detached(signature, message, size, key) != 0);
            signature[bit / 8] ^= (uint8_t)(1u << bit % 8);
        }
        message[0] ^= 1;
        if (size > 0)
            CHECK(crypto_sign_ed25519_verify_detached(signature, message, size, key) != 0);
    }
}

/* Small multiples of the order, all bits, and random numbers: as libsodium reduces them. */
TEST(reduces_scalars_as_libsodium_does)
{
    uint8_t ours[64], theirs[64];

    for (unsigned n = 0; n < 20000; n++) {
        for (unsigned i = 0; i < sizeof ours; i++)
            ours[i] = n == 0 ? 0xff : (uint8_t)(n % 3 == 0 && i > 31 ? 0 : random_below(256));
        if (n % 3 == 1)
            memset(ours, 0xff, 1 + n % 60);
        memcpy(theirs, ours, sizeof ours);
        sc25519_reduce(ours);
        sc25519_reduce_unrolled(theirs);
        CHECK(memcmp(ours, theirs, 32) == 0);
    }
}

/* FIPS 180-4's examples: "abc", and a million times "a" in pieces of odd lengths. */
TEST(hashes_as_the_standard_says)
{
    static uint8_t many[1000];
    uint8_t expected[64], result[64];
    crypto_hash_sha256_state sha256;
    crypto_hash_sha512_state sha512;

    memset(many, 'a', sizeof many);
    crypto_hash_sha256_init(&sha256);
    crypto_hash_sha256_update(&sha256, (const uint8_t *)"abc", 3);
    crypto_hash_sha256_final(&sha256, result);
    from_hex("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad", expected);
    CHECK(memcmp(result, expected, 32) == 0);
    crypto_hash_sha512_init(&sha512);
    crypto_hash_sha512_update(&sha512, (const uint8_t *)"abc", 3);
    crypto_hash_sha512_final(&sha512, result);
    from_hex("ddaf35a193617abacc417349ae20413112e6fa4e89a97ea20a9eeee64b55d39a"
             "2192992a274fc1a836ba3c23a3feebbd454d4423643ce80e2a9ac94fa54ca49f", expected);
    CHECK(memcmp(result, expected, 64) == 0);
    crypto_hash_sha256_init(&sha256);
    crypto_hash_sha512_init(&sha512);
    for (unsigned left = 1000000, size = 1; left > 0; left -= size, size = size * 7 % 997 + 1) {
        if (size > left)
            size = left;
        crypto_hash_sha256_update(&sha256, many, size);
        crypto_hash_sha512_update(&sha512, many, size);
    }
    crypto_hash_sha256_final(&sha256, result);
    from_hex("cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0", expected);
    CHECK(memcmp(result, expected, 32) == 0);
    crypto_hash_sha512_final(&sha512, result);
    from_hex("e718483d0ce769644e2e42c7bc15b4638e1f98b13b2044285632a803afa973eb"
             "de0ff244877ea60a4cb0432ce577c31beb009c5c2c49aa2e4eadb217ad8cc09b", expected);
    CHECK(memcmp(result, expected, 64) == 0);
}

TEST_MAIN(RUN(takes_what_imgtool_signs); RUN(says_why_it_refuses); RUN(refuses_what_is_older_than_allowed);
          RUN(refuses_a_file_that_ends_early); RUN(notices_every_wrong_bit); RUN(verifies_the_signatures_of_rfc_8032);
          RUN(reduces_scalars_as_libsodium_does); RUN(hashes_as_the_standard_says))
