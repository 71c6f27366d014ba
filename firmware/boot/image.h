/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Application images in the format of MCUboot, as imgtool makes them: header, program, TLVs with digest and signature.
 *
 *     offset             bytes   what
 *     0                  32      header (imgtool); loaded to RAM with the program
 *     32                 16      first instruction, "Abbe", product, version of the register map (start.S)
 *     48                         the rest of the program
 *     header + program           protected TLVs, if any: part of what is signed, otherwise not looked at
 *                                TLVs: SHA-256 or SHA-512 of all before; hash of the key, or the key; Ed25519 of the digest
 *
 * Nothing here is believed before the signature over the copy in RAM has been verified, except to refuse an image.
 */
#ifndef BOOT_IMAGE_H
#define BOOT_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    IMAGE_HEADER_BYTES = 32,
    IMAGE_START_BYTES = 48,   /* what image_check_start looks at */
    IMAGE_RAM = 0x20000,      /* where the header is loaded; the program begins behind it */
    IMAGE_RAM_BYTES = 240 << 10, /* header and program; the boot program has the rest of RAM while it runs */
    IMAGE_FILE_BYTES = IMAGE_RAM_BYTES + 4096, /* the same with TLVs */
    IMAGE_HASH_BYTES_MAX = 64,

    IMAGE_MARK = 0x65626241, /* "Abbe" */
    IMAGE_PRODUCT = 1,       /* the four-axis stage controller; another product has another number */
};

/** Why an image is not started. */
enum image_verdict {
    IMAGE_VALID,
    IMAGE_NONE,            /* no header of an image */
    IMAGE_BAD_HEADER,      /* encrypted, compressed, not bootable, or sizes that cannot be */
    IMAGE_TOO_LARGE,
    IMAGE_TRUNCATED,       /* shorter than its header says */
    IMAGE_ELSEWHERE,       /* to be loaded to another address */
    IMAGE_OTHER_PRODUCT,
    IMAGE_OTHER_GATEWARE,  /* built for another register map */
    IMAGE_OLDER,           /* than the version that must not be gone back behind */
    IMAGE_BAD_TLVS,
    IMAGE_NO_DIGEST,
    IMAGE_WRONG_DIGEST,
    IMAGE_UNSIGNED,
    IMAGE_OTHER_KEY,       /* signed, it says itself, with a key that is not ours */
    IMAGE_WRONG_SIGNATURE,
    IMAGE_UNREADABLE,      /* the flash does not answer */
    IMAGE_VERDICTS,
};

struct image_version {
    uint8_t major, minor;
    uint16_t revision;
    uint32_t build;
};

struct image {
    struct image_version version;
    uint32_t loaded_bytes;    /* header and program */
    uint32_t protected_bytes; /* of protected TLVs, with their header */
    uint8_t hash[IMAGE_HASH_BYTES_MAX];
    size_t hash_bytes;        /* 32 or 64; 0: not known */
};

/** What "older" compares: major, minor, revision in one number, as `imgtool --security-counter auto`; not the build. */
uint32_t image_counter(const struct image_version *version);

/** A sentence, without a full stop. */
const char *image_verdict_text(enum image_verdict verdict);

/**
 * Judge the beginning of an image.
 *
 * @param start          Its first IMAGE_START_BYTES.
 * @param file_bytes     Length of the whole image, or of the room it is in.
 * @param counter_least  Smallest image_counter that is allowed.
 * @param image          Filled in, but for the hash, as far as the verdict is IMAGE_VALID.
 */
enum image_verdict image_check_start(const uint8_t start[IMAGE_START_BYTES], uint32_t file_bytes, uint32_t counter_least,
                                     struct image *image);

/**
 * Copy an image out of flash and verify the copy.
 *
 * @param address        Of its header in flash.
 * @param file_bytes     Room it is in, all of which may be read.
 * @param memory         IMAGE_RAM_BYTES. Left alone when the beginning is refused; when the rest is, image_is_application
 *                       is false of what is there.
 */
enum image_verdict image_load(uint32_t address, uint32_t file_bytes, uint32_t counter_least, uint8_t *memory,
                              struct image *image);

/** Whether a program for this product and gateware begins in memory; nothing is said of where it comes from. */
bool image_is_application(const uint8_t memory[IMAGE_START_BYTES]);

#endif
