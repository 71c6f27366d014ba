/* SPDX-License-Identifier: BSD-2-Clause */
#include "boot/smp.h"

#include <string.h>

enum {
    HEADER_BYTES = 8,
    OPERATION_BITS = 0x07,
    VERSION_BITS = 0x18,
    READ = 0,
    WRITE = 2,
    RESPONSE = 1, /* added to the operation */
    GROUP_OS = 0,
    GROUP_IMAGE = 1,
    NESTED = 4, /* maps and lists in each other, at most */
};

static bool key_is(const struct zcbor_string *key, const char *text)
{
    return key->len == strlen(text) && memcmp(key->value, text, key->len) == 0;
}

/* An entry nobody here knows, if it is a plain value. */
static bool skip_plain(zcbor_state_t *state)
{
    struct zcbor_string string;
    int64_t number;
    bool truth;

    return zcbor_tstr_decode(state, &string) || zcbor_bstr_decode(state, &string) || zcbor_int64_decode(state, &number) ||
           zcbor_bool_decode(state, &truth) || zcbor_nil_expect(state, NULL);
}

static bool take_number(zcbor_state_t *state, uint32_t *number, bool *there)
{
    /* null is as good as nothing. */
    *there = zcbor_uint32_decode(state, number);
    return *there || zcbor_nil_expect(state, NULL);
}

static bool take_bytes(zcbor_state_t *state, struct zcbor_string *string)
{
    return zcbor_bstr_decode(state, string) || zcbor_nil_expect(state, NULL);
}

static bool take_truth(zcbor_state_t *state, bool *truth)
{
    return zcbor_bool_decode(state, truth) || zcbor_nil_expect(state, NULL);
}

static bool take_entry(zcbor_state_t *state, struct smp_request *request)
{
    struct zcbor_string key;

    if (!zcbor_tstr_decode(state, &key))
        return false;
    if (key_is(&key, "d"))
        return zcbor_tstr_decode(state, &request->d);
    if (key_is(&key, "query"))
        return zcbor_tstr_decode(state, &request->query);
    if (key_is(&key, "data"))
        return take_bytes(state, &request->data);
    if (key_is(&key, "sha"))
        return take_bytes(state, &request->sha);
    if (key_is(&key, "hash"))
        return take_bytes(state, &request->hash);
    if (key_is(&key, "off"))
        return take_number(state, &request->off, &request->has_off);
    if (key_is(&key, "len"))
        return take_number(state, &request->len, &request->has_len);
    if (key_is(&key, "image"))
        return take_number(state, &request->image, &request->has_image);
    if (key_is(&key, "slot"))
        return take_number(state, &request->slot, &request->has_slot);
    if (key_is(&key, "upgrade"))
        return take_truth(state, &request->upgrade);
    if (key_is(&key, "confirm"))
        return take_truth(state, &request->confirm);
    return skip_plain(state);
}

/* The map behind the header. */
static bool take_map(const uint8_t *bytes, size_t size, struct smp_request *request)
{
    ZCBOR_STATE_D(state, NESTED, bytes, size, 1, 0);

    if (!zcbor_map_start_decode(state))
        return false;
    while (!zcbor_array_at_end(state))
        if (!take_entry(state, request))
            return false;
    return zcbor_map_end_decode(state);
}

bool smp_put_text(zcbor_state_t *response, const char *key, const char *text)
{
    return zcbor_tstr_encode_ptr(response, key, strlen(key)) && zcbor_tstr_encode_ptr(response, text, strlen(text));
}

static struct smp_result dispatch(const struct smp_request *request, zcbor_state_t *response)
{
    if (request->group == GROUP_OS)
        return smp_os(request, response);
    if (request->group == GROUP_IMAGE)
        return smp_image(request, response);
    return smp_refuse(SMP_NOT_SUPPORTED, "no such group");
}

/* The response's map at `bytes`; its size. */
static size_t respond(const struct smp_request *request, bool understood, uint8_t *bytes, size_t room)
{
    struct smp_result result = smp_refuse(SMP_INVALID, "no map that can be read");
    ZCBOR_STATE_E(response, NESTED, bytes, room, 1);
    bool fits = zcbor_map_start_encode(response, 16);

    if (understood)
        result = dispatch(request, response);
    if (result.code != SMP_OK) {
        /* What the handler may have put there is dropped. */
        zcbor_new_encode_state(response, NESTED + 2, bytes, room, 1);
        fits = zcbor_map_start_encode(response, 16) && zcbor_tstr_put_lit(response, "rc") &&
               zcbor_uint32_put(response, result.code) && smp_put_text(response, "rsn", result.reason);
    }
    return fits && zcbor_map_end_encode(response, 16) ? (size_t)(response->payload - bytes) : 0;
}

size_t smp_handle(const uint8_t *request, size_t size, uint8_t *response, size_t room)
{
    struct smp_request parts;
    size_t map_bytes, body;

    memset(&parts, 0, sizeof parts);
    if (size < HEADER_BYTES || room < HEADER_BYTES)
        return 0;
    map_bytes = (size_t)request[2] << 8 | request[3];
    parts.write = (request[0] & OPERATION_BITS) == WRITE;
    if (map_bytes != size - HEADER_BYTES || (!parts.write && (request[0] & OPERATION_BITS) != READ))
        return 0;
    parts.group = request[4] != 0 ? UINT8_MAX : request[5];
    parts.command = request[7];
    body = respond(&parts, take_map(request + HEADER_BYTES, map_bytes, &parts), response + HEADER_BYTES,
                   room - HEADER_BYTES);
    memcpy(response, request, HEADER_BYTES); /* group, sequence number and command are the request's */
    response[0] = (uint8_t)((request[0] & (OPERATION_BITS | VERSION_BITS)) + RESPONSE);
    response[1] = 0;
    response[2] = (uint8_t)(body >> 8);
    response[3] = (uint8_t)body;
    return body == 0 ? 0 : HEADER_BYTES + body;
}

void smp_init(uint8_t *memory, int running)
{
    smp_os_init();
    smp_image_init(memory, running);
}
