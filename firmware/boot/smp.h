/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The update server: SMP requests to responses, for the groups os (smp_os.c) and image (smp_image.c).
 *
 * A refusal is {"rc": code, "rsn": sentence} in both versions of the protocol. A request that is no SMP packet gets none.
 */
#ifndef BOOT_SMP_H
#define BOOT_SMP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "zcbor_decode.h"
#include "zcbor_encode.h"

/** Codes of a refusal, as in every SMP server. */
enum smp_error {
    SMP_OK = 0,
    SMP_UNKNOWN = 1,
    SMP_INVALID = 3,
    SMP_NOT_FOUND = 5,
    SMP_BAD_STATE = 6,
    SMP_NOT_SUPPORTED = 8,
    SMP_CORRUPT = 9,
    SMP_DENIED = 11,
};

/** Result of a handler: a code, and why if it is not SMP_OK. */
struct smp_result {
    enum smp_error code;
    const char *reason;
};

static inline struct smp_result smp_refuse(enum smp_error code, const char *reason)
{
    return (struct smp_result){.code = code, .reason = reason};
}

#define SMP_DONE ((struct smp_result){.code = SMP_OK})

/** What a request says in its map; strings point into the request. */
struct smp_request {
    bool write;
    uint8_t group, command;
    struct zcbor_string d, data, sha, hash, query; /* value NULL: not there */
    uint32_t off, len, image, slot;
    bool has_off, has_len, has_image, has_slot, upgrade, confirm;
};

/** Handlers of a group: put entries into the response's map. */
struct smp_result smp_os(const struct smp_request *request, zcbor_state_t *response);
struct smp_result smp_image(const struct smp_request *request, zcbor_state_t *response);

/** Write `"key": "text"`. */
bool smp_put_text(zcbor_state_t *response, const char *key, const char *text);

/**
 * Carry out one request.
 *
 * @param response  At least `room` bytes.
 * @return          Bytes of the response; 0: none.
 */
size_t smp_handle(const uint8_t *request, size_t size, uint8_t *response, size_t room);

/** A request for a reset was answered. */
bool smp_reset_wanted(void);

/**
 * Forget everything, and serve slots.
 *
 * @param memory   IMAGE_RAM_BYTES, for verifying images.
 * @param running  Slot whose application asked for the update, or SLOT_NONE.
 */
void smp_init(uint8_t *memory, int running);

/** For smp_init: the two groups' own. */
void smp_os_init(void);
void smp_image_init(uint8_t *memory, int running);

#endif
