/* SPDX-License-Identifier: BSD-2-Clause */
#include "boot/image.h"

#include <stdbool.h>
#include <string.h>

#include "boot/key.h"
#include "crypto_hash_sha256.h"
#include "crypto_hash_sha512.h"
#include "crypto_sign_ed25519.h"
#include "hal/flash.h"
#include "regs.h"

#define HEADER_MAGIC 0x96f3b83du
#define TLVS_MAGIC 0x6907u
#define PROTECTED_TLVS_MAGIC 0x6908u

enum {
    FLAG_RAM_LOAD = 0x20,
    TLV_KEY_HASH = 0x01,
    TLV_KEY = 0x02,
    TLV_SHA256 = 0x10,
    TLV_SHA512 = 0x12,
    TLV_ED25519 = 0x24,
    TLV_HEADER_BYTES = 4, /* of one, and of all */
    SIGNATURE_BYTES = 64,
    COPY_BYTES = 256,
};

static uint32_t word16(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8;
}

static uint32_t word32(const uint8_t *bytes)
{
    return word16(bytes) | word16(bytes + 2) << 16;
}

uint32_t image_counter(const struct image_version *version)
{
    return (uint32_t)version->major << 24 | (uint32_t)version->minor << 16 | version->revision;
}

const char *image_verdict_text(enum image_verdict verdict)
{
    static const char *const texts[IMAGE_VERDICTS] = {
        [IMAGE_VALID] = "valid",
        [IMAGE_NONE] = "no image",
        [IMAGE_BAD_HEADER] = "bad image header",
        [IMAGE_TOO_LARGE] = "image too large",
        [IMAGE_TRUNCATED] = "image truncated",
        [IMAGE_ELSEWHERE] = "image for another address",
        [IMAGE_OTHER_PRODUCT] = "image for another product",
        [IMAGE_OTHER_GATEWARE] = "image for other gateware",
        [IMAGE_OLDER] = "image older than allowed",
        [IMAGE_BAD_TLVS] = "bad image TLVs",
        [IMAGE_NO_DIGEST] = "image without digest",
        [IMAGE_WRONG_DIGEST] = "wrong image digest",
        [IMAGE_UNSIGNED] = "image not signed",
        [IMAGE_OTHER_KEY] = "image signed with another key",
        [IMAGE_WRONG_SIGNATURE] = "wrong image signature",
        [IMAGE_UNREADABLE] = "flash does not answer",
    };

    return texts[verdict];
}

enum image_verdict image_check_start(const uint8_t start[IMAGE_START_BYTES], uint32_t file_bytes, uint32_t counter_least,
                                     struct image *image)
{
    const uint32_t header_bytes = word16(start + 8), protected_bytes = word16(start + 10);
    const uint32_t program_bytes = word32(start + 12), flags = word32(start + 16);
    const uint8_t *program = start + IMAGE_HEADER_BYTES;

    memset(image, 0, sizeof *image);
    if (word32(start) != HEADER_MAGIC)
        return IMAGE_NONE;
    if (header_bytes != IMAGE_HEADER_BYTES || program_bytes < IMAGE_START_BYTES - IMAGE_HEADER_BYTES ||
        (flags & ~(uint32_t)FLAG_RAM_LOAD) != 0)
        return IMAGE_BAD_HEADER;
    if (program_bytes > IMAGE_RAM_BYTES - IMAGE_HEADER_BYTES)
        return IMAGE_TOO_LARGE;
    if (header_bytes + program_bytes + protected_bytes + TLV_HEADER_BYTES > file_bytes)
        return IMAGE_TRUNCATED;
    if ((flags & FLAG_RAM_LOAD) == 0 || word32(start + 4) != IMAGE_RAM)
        return IMAGE_ELSEWHERE;
    if (word32(program + 4) != IMAGE_MARK || word32(program + 8) != IMAGE_PRODUCT)
        return IMAGE_OTHER_PRODUCT;
    if (word32(program + 12) != REG_MAP_VERSION)
        return IMAGE_OTHER_GATEWARE;
    image->version = (struct image_version){
        .major = start[20], .minor = start[21], .revision = (uint16_t)word16(start + 22), .build = word32(start + 24),
    };
    image->loaded_bytes = header_bytes + program_bytes;
    image->protected_bytes = protected_bytes;
    return image_counter(&image->version) < counter_least ? IMAGE_OLDER : IMAGE_VALID;
}

/* --- digests ------------------------------------------------------------------------------------------------ */

/* One of the two, as the image has it. */
struct digest {
    bool is_512;
    union {
        crypto_hash_sha256_state sha256;
        crypto_hash_sha512_state sha512;
    } state;
};

static void digest_init(struct digest *digest, size_t bytes)
{
    digest->is_512 = bytes == crypto_hash_sha512_BYTES;
    if (digest->is_512)
        crypto_hash_sha512_init(&digest->state.sha512);
    else
        crypto_hash_sha256_init(&digest->state.sha256);
}

static void digest_update(struct digest *digest, const uint8_t *bytes, size_t size)
{
    if (digest->is_512)
        crypto_hash_sha512_update(&digest->state.sha512, bytes, size);
    else
        crypto_hash_sha256_update(&digest->state.sha256, bytes, size);
}

static bool digest_equals(struct digest *digest, const uint8_t *expected)
{
    uint8_t result[IMAGE_HASH_BYTES_MAX];

    if (digest->is_512)
        crypto_hash_sha512_final(&digest->state.sha512, result);
    else
        crypto_hash_sha256_final(&digest->state.sha256, result);
    return memcmp(result, expected, digest->is_512 ? crypto_hash_sha512_BYTES : crypto_hash_sha256_BYTES) == 0;
}

/* --- TLVs --------------------------------------------------------------------------------------------------- */

/* What the TLVs say. */
struct tlvs {
    uint8_t hash[IMAGE_HASH_BYTES_MAX];
    size_t hash_bytes;
    uint8_t key[IMAGE_HASH_BYTES_MAX]; /* its hash, or the key itself as DER */
    size_t key_bytes;
    bool key_is_hash;
    uint8_t signature[SIGNATURE_BYTES];
    bool is_signed;
};

/* Read a value that there may be once. False: there is another, it has not a length that it can have, or no answer. */
static bool take(uint32_t address, void *value, size_t *known, size_t bytes, size_t expected)
{
    if (*known != 0 || bytes != expected || !flash_read(address, value, bytes))
        return false;
    *known = bytes;
    return true;
}

static bool take_tlv(struct tlvs *tlvs, uint32_t type, uint32_t address, size_t bytes)
{
    size_t known = tlvs->is_signed ? SIGNATURE_BYTES : 0;

    switch (type) {
    case TLV_SHA256:
        return take(address, tlvs->hash, &tlvs->hash_bytes, bytes, crypto_hash_sha256_BYTES);
    case TLV_SHA512:
        return take(address, tlvs->hash, &tlvs->hash_bytes, bytes, crypto_hash_sha512_BYTES);
    case TLV_KEY_HASH:
        /* With the algorithm of the digest, which imgtool writes before it. */
        tlvs->key_is_hash = true;
        return take(address, tlvs->key, &tlvs->key_bytes, bytes, tlvs->hash_bytes);
    case TLV_KEY:
        return take(address, tlvs->key, &tlvs->key_bytes, bytes, KEY_DER_BYTES);
    case TLV_ED25519:
        tlvs->is_signed = true;
        return take(address, tlvs->signature, &known, bytes, SIGNATURE_BYTES);
    default:
        return true;
    }
}

/* The unprotected TLVs at `address`, none of which reaches `end`. */
static enum image_verdict read_tlvs(uint32_t address, uint32_t end, struct tlvs *tlvs)
{
    uint8_t header[TLV_HEADER_BYTES];
    uint32_t total;

    memset(tlvs, 0, sizeof *tlvs);
    if (!flash_read(address, header, sizeof header))
        return IMAGE_UNREADABLE;
    total = word16(header + 2);
    if (word16(header) != TLVS_MAGIC || total < TLV_HEADER_BYTES)
        return IMAGE_BAD_TLVS;
    if (total > end - address)
        return IMAGE_TRUNCATED;
    end = address + total;
    for (address += TLV_HEADER_BYTES; address < end;) {
        uint32_t bytes;

        if (end - address < TLV_HEADER_BYTES)
            return IMAGE_BAD_TLVS;
        if (!flash_read(address, header, sizeof header))
            return IMAGE_UNREADABLE;
        address += TLV_HEADER_BYTES;
        bytes = word16(header + 2);
        if (bytes > end - address || !take_tlv(tlvs, word16(header), address, bytes))
            return IMAGE_BAD_TLVS;
        address += bytes;
    }
    return IMAGE_VALID;
}

static bool key_is_ours(const struct tlvs *tlvs)
{
    struct digest digest;

    if (!tlvs->key_is_hash)
        return memcmp(tlvs->key, ed25519_pub_key, KEY_DER_BYTES) == 0;
    digest_init(&digest, tlvs->hash_bytes);
    digest_update(&digest, ed25519_pub_key, KEY_DER_BYTES);
    return digest_equals(&digest, tlvs->key);
}

/* Header and program are hashed as they are in RAM, the protected TLVs as they come out of flash. */
static enum image_verdict check_digest(const struct image *image, const struct tlvs *tlvs, const uint8_t *memory,
                                       uint32_t address)
{
    struct digest digest;
    uint8_t copy[COPY_BYTES];

    digest_init(&digest, tlvs->hash_bytes);
    digest_update(&digest, memory, image->loaded_bytes);
    for (uint32_t left = image->protected_bytes; left > 0;) {
        uint32_t bytes = left < sizeof copy ? left : sizeof copy;

        if (!flash_read(address, copy, bytes))
            return IMAGE_UNREADABLE;
        /* Their header has to be there, and no more: it is the image's that says how many there are. */
        if (left == image->protected_bytes && (word16(copy) != PROTECTED_TLVS_MAGIC || word16(copy + 2) != left))
            return IMAGE_BAD_TLVS;
        digest_update(&digest, copy, bytes);
        address += bytes;
        left -= bytes;
    }
    return digest_equals(&digest, tlvs->hash) ? IMAGE_VALID : IMAGE_WRONG_DIGEST;
}

/* The rest of an image whose beginning was judged and is in `memory`, which is not read again: it is what is signed. */
static enum image_verdict load_rest(uint32_t address, uint32_t file_bytes, uint8_t *memory, struct image *image)
{
    enum image_verdict verdict;
    struct tlvs tlvs;
    uint32_t behind;

    if (!flash_read(address + IMAGE_START_BYTES, memory + IMAGE_START_BYTES, image->loaded_bytes - IMAGE_START_BYTES))
        return IMAGE_UNREADABLE;
    behind = address + image->loaded_bytes;
    verdict = read_tlvs(behind + image->protected_bytes, address + file_bytes, &tlvs);
    if (verdict != IMAGE_VALID)
        return verdict;
    if (tlvs.hash_bytes == 0)
        return IMAGE_NO_DIGEST;
    verdict = check_digest(image, &tlvs, memory, behind);
    if (verdict != IMAGE_VALID)
        return verdict;
    if (!tlvs.is_signed || tlvs.key_bytes == 0)
        return IMAGE_UNSIGNED;
    if (!key_is_ours(&tlvs))
        return IMAGE_OTHER_KEY;
    if (crypto_sign_ed25519_verify_detached(tlvs.signature, tlvs.hash, tlvs.hash_bytes,
                                            ed25519_pub_key + KEY_DER_BYTES - KEY_BYTES) != 0)
        return IMAGE_WRONG_SIGNATURE;
    memcpy(image->hash, tlvs.hash, tlvs.hash_bytes);
    image->hash_bytes = tlvs.hash_bytes;
    return IMAGE_VALID;
}

enum image_verdict image_load(uint32_t address, uint32_t file_bytes, uint32_t counter_least, uint8_t *memory,
                              struct image *image)
{
    enum image_verdict verdict;
    uint8_t start[IMAGE_START_BYTES];

    memset(image, 0, sizeof *image);
    if (file_bytes < IMAGE_START_BYTES || !flash_read(address, start, sizeof start))
        return IMAGE_UNREADABLE;
    verdict = image_check_start(start, file_bytes, counter_least, image);
    if (verdict != IMAGE_VALID)
        return verdict;
    memcpy(memory, start, sizeof start);
    verdict = load_rest(address, file_bytes, memory, image);
    if (verdict != IMAGE_VALID)
        memset(memory, 0, sizeof start);
    return verdict;
}

bool image_is_application(const uint8_t memory[IMAGE_START_BYTES])
{
    const uint8_t *program = memory + IMAGE_HEADER_BYTES;

    return word32(program + 4) == IMAGE_MARK && word32(program + 8) == IMAGE_PRODUCT && word32(program + 12) == REG_MAP_VERSION;
}
