/* SPDX-License-Identifier: BSD-2-Clause */
/* Group 1: the images in the slots, and the upload of one. */
#include <string.h>

#include "boot/counter.h"
#include "boot/image.h"
#include "boot/slot.h"
#include "boot/smp.h"
#include "crypto_hash_sha256.h"

enum { STATE = 0, UPLOAD = 1, ERASE = 5, VERSION_TEXT_BYTES = 32 };

/* What a slot holds, verified once and remembered until it is written. */
struct content {
    bool known;
    enum image_verdict verdict;
    struct image image;
};

/* The upload that is under way, or was when the line broke. */
struct upload {
    bool open;
    int slot;
    uint32_t size, offset, erased; /* offset: bytes received; erased: up to here the slot is */
    bool has_sha;
    uint8_t sha[crypto_hash_sha256_BYTES];
    crypto_hash_sha256_state hash;
};

static struct {
    uint8_t *memory;
    int running;
    struct content contents[SLOT_COUNT];
    struct upload upload;
} server;

void smp_image_init(uint8_t *memory, int running)
{
    memset(&server, 0, sizeof server);
    server.memory = memory;
    server.running = running;
}

/* Verify the image in a slot, which ends within so many bytes. */
static enum image_verdict verify(int slot, uint32_t file_bytes)
{
    struct content *content = &server.contents[slot];

    content->verdict = image_load(slot_address(slot), file_bytes, counter_read(), server.memory, &content->image);
    content->known = true;
    return content->verdict;
}

static const struct content *content(int slot)
{
    if (!server.contents[slot].known)
        (void)verify(slot, SLOT_IMAGE_BYTES);
    return &server.contents[slot];
}

static unsigned valid_slots(void)
{
    unsigned valid = 0;

    for (int n = 0; n < SLOT_COUNT; n++)
        if (content(n)->verdict == IMAGE_VALID)
            valid |= 1u << n;
    return valid;
}

static void read_slots(struct slot slots[SLOT_COUNT])
{
    for (int n = 0; n < SLOT_COUNT; n++)
        slots[n] = slot_read(n);
}

/* The slot that a reset would start. */
static int next_slot(const struct slot slots[SLOT_COUNT])
{
    return slot_choose(slots, ~valid_slots());
}

static int active_slot(const struct slot slots[SLOT_COUNT])
{
    return server.running != SLOT_NONE ? server.running : next_slot(slots);
}

static enum smp_error code_of(enum image_verdict verdict)
{
    switch (verdict) {
    case IMAGE_OLDER:
    case IMAGE_UNSIGNED:
    case IMAGE_OTHER_KEY:
    case IMAGE_WRONG_SIGNATURE:
        return SMP_DENIED;
    case IMAGE_WRONG_DIGEST:
        return SMP_CORRUPT;
    case IMAGE_UNREADABLE:
        return SMP_UNKNOWN;
    default:
        return SMP_INVALID;
    }
}

static struct smp_result refuse_image(enum image_verdict verdict)
{
    return smp_refuse(code_of(verdict), image_verdict_text(verdict));
}

static struct smp_result flash_failed(void)
{
    return smp_refuse(SMP_UNKNOWN, "flash not written");
}

/* --- state -------------------------------------------------------------------------------------------------- */

static char *put_decimal(char *to, uint32_t value)
{
    char digits[10];
    unsigned count = 0;

    do {
        digits[count++] = (char)('0' + value % 10);
        value /= 10;
    } while (value != 0);
    while (count > 0)
        *to++ = digits[--count];
    return to;
}

/* "1.2.3", and ".4" if there is a build number. */
static void version_text(const struct image_version *version, char text[VERSION_TEXT_BYTES])
{
    char *end = put_decimal(text, version->major);

    *end++ = '.';
    end = put_decimal(end, version->minor);
    *end++ = '.';
    end = put_decimal(end, version->revision);
    if (version->build != 0) {
        *end++ = '.';
        end = put_decimal(end, version->build);
    }
    *end = '\0';
}

static bool put_truth(zcbor_state_t *response, const char *key, bool truth)
{
    return zcbor_tstr_encode_ptr(response, key, strlen(key)) && zcbor_bool_put(response, truth);
}

static bool put_image(zcbor_state_t *response, int slot, const struct slot slots[SLOT_COUNT])
{
    const struct image *image = &content(slot)->image;
    const bool next = slot == next_slot(slots), active = slot == active_slot(slots);
    const bool confirmed = slots[slot].state == SLOT_CONFIRMED;
    char version[VERSION_TEXT_BYTES];

    version_text(&image->version, version);
    return zcbor_map_start_encode(response, 16) && zcbor_tstr_put_lit(response, "slot") &&
           zcbor_int32_put(response, slot) && smp_put_text(response, "version", version) &&
           zcbor_tstr_put_lit(response, "hash") &&
           zcbor_bstr_encode_ptr(response, (const char *)image->hash, image->hash_bytes) &&
           put_truth(response, "bootable", true) &&
           put_truth(response, "pending", slots[slot].state == SLOT_PENDING || (next && !active)) &&
           put_truth(response, "confirmed", confirmed) && put_truth(response, "active", active) &&
           put_truth(response, "permanent", confirmed && next && !active) && zcbor_map_end_encode(response, 16);
}

static struct smp_result list(zcbor_state_t *response)
{
    struct slot slots[SLOT_COUNT];
    const unsigned valid = valid_slots();
    bool fits = zcbor_tstr_put_lit(response, "images") && zcbor_list_start_encode(response, SLOT_COUNT);

    read_slots(slots);
    for (int n = 0; n < SLOT_COUNT; n++)
        if ((valid >> n & 1u) != 0)
            fits = fits && put_image(response, n, slots);
    fits = fits && zcbor_list_end_encode(response, SLOT_COUNT);
    return fits ? SMP_DONE : smp_refuse(SMP_INVALID, "response too long");
}

/* The slot that a request means: by hash, or the active one. */
static int slot_meant(const struct smp_request *request, const struct slot slots[SLOT_COUNT])
{
    const unsigned valid = valid_slots();

    if (request->hash.value == NULL)
        return request->confirm ? active_slot(slots) : SLOT_NONE;
    for (int n = 0; n < SLOT_COUNT; n++) {
        const struct image *image = &content(n)->image;

        if ((valid >> n & 1u) != 0 && request->hash.len == image->hash_bytes &&
            memcmp(request->hash.value, image->hash, image->hash_bytes) == 0)
            return n;
    }
    return SLOT_NONE;
}

static struct smp_result set_state(const struct smp_request *request, zcbor_state_t *response)
{
    struct slot slots[SLOT_COUNT];
    int slot;
    bool done = true;

    read_slots(slots);
    slot = slot_meant(request, slots);
    if (slot == SLOT_NONE)
        return smp_refuse(SMP_NOT_FOUND, "no such image");
    if (content(slot)->verdict != IMAGE_VALID)
        return refuse_image(content(slot)->verdict);
    if (request->confirm) {
        /* What ran is confirmed where it stands. The other one has to be selected to come first. */
        if (slot == server.running && (slots[slot].state == SLOT_TRIED || slots[slot].state == SLOT_PENDING))
            done = slot_confirm(slot);
        else if (slots[slot].state != SLOT_CONFIRMED || slot != next_slot(slots))
            done = slot_select(slot, true);
    } else if (slots[slot].state == SLOT_CONFIRMED && slot == slot_keep(slots, valid_slots())) {
        return smp_refuse(SMP_BAD_STATE, "image is confirmed");
    } else if (slots[slot].state != SLOT_PENDING || slot != next_slot(slots)) {
        done = slot_select(slot, false);
    }
    return done ? list(response) : flash_failed();
}

/* --- upload ------------------------------------------------------------------------------------------------- */

/* Where an upload goes: not over the image to fall back to. */
static int upload_slot(void)
{
    struct slot slots[SLOT_COUNT];
    int keep;

    read_slots(slots);
    keep = slot_keep(slots, valid_slots());
    return keep == 0 ? 1 : 0;
}

/* Nothing of the slot's old image counts from here on. */
static bool discard(int slot)
{
    server.contents[slot].known = false;
    if (slot == server.running)
        server.running = SLOT_NONE;
    return slot_unselect(slot) && flash_erase(slot_address(slot));
}

static uint32_t newest_counter(void)
{
    struct slot slots[SLOT_COUNT];
    int active;

    read_slots(slots);
    active = active_slot(slots);
    return active == SLOT_NONE ? 0 : image_counter(&content(active)->image.version);
}

static struct smp_result begin(const struct smp_request *request)
{
    struct upload *upload = &server.upload;
    uint32_t counter_least = counter_read();
    enum image_verdict verdict;
    struct slot slots[SLOT_COUNT];
    struct image image;
    int keep;

    if (!request->has_len || (request->sha.value != NULL && request->sha.len != sizeof upload->sha))
        return smp_refuse(SMP_INVALID, "no length, or no SHA-256");
    if (request->has_image && request->image > 1)
        return smp_refuse(SMP_INVALID, "no such image number");
    if (request->len > IMAGE_FILE_BYTES)
        return refuse_image(IMAGE_TOO_LARGE);
    if (request->data.len < IMAGE_START_BYTES)
        return refuse_image(request->len < IMAGE_START_BYTES ? IMAGE_TRUNCATED : IMAGE_BAD_HEADER);
    /* Also not behind what is confirmed but was not yet started from power-up. */
    read_slots(slots);
    keep = slot_keep(slots, valid_slots());
    if (keep != SLOT_NONE && slots[keep].state == SLOT_CONFIRMED &&
        image_counter(&content(keep)->image.version) > counter_least)
        counter_least = image_counter(&content(keep)->image.version);
    if (request->upgrade && newest_counter() + 1 > counter_least)
        counter_least = newest_counter() + 1;
    verdict = image_check_start(request->data.value, request->len, counter_least, &image);
    if (verdict != IMAGE_VALID)
        return refuse_image(verdict);
    memset(upload, 0, sizeof *upload);
    upload->slot = upload_slot();
    if (!discard(upload->slot))
        return flash_failed();
    upload->size = request->len;
    upload->erased = FLASH_SECTOR;
    if (request->sha.value != NULL) {
        upload->has_sha = true;
        memcpy(upload->sha, request->sha.value, sizeof upload->sha);
    }
    crypto_hash_sha256_init(&upload->hash);
    upload->open = true;
    return SMP_DONE;
}

static bool store(const uint8_t *bytes, size_t size)
{
    struct upload *upload = &server.upload;
    const uint32_t address = slot_address(upload->slot);

    while (upload->erased < upload->offset + size) {
        if (!flash_erase(address + upload->erased))
            return false;
        upload->erased += FLASH_SECTOR;
    }
    if (!flash_program(address + upload->offset, bytes, size))
        return false;
    crypto_hash_sha256_update(&upload->hash, bytes, size);
    upload->offset += (uint32_t)size;
    return true;
}

/* All has come: is it what was sent, and is it any good? */
static struct smp_result finish(void)
{
    struct upload *upload = &server.upload;
    uint8_t sha[crypto_hash_sha256_BYTES];
    enum image_verdict verdict;

    upload->open = false;
    crypto_hash_sha256_final(&upload->hash, sha);
    if (upload->has_sha && memcmp(sha, upload->sha, sizeof sha) != 0) {
        (void)discard(upload->slot);
        return smp_refuse(SMP_CORRUPT, "not the SHA-256 announced");
    }
    verdict = verify(upload->slot, upload->size);
    if (verdict != IMAGE_VALID) {
        (void)discard(upload->slot);
        return refuse_image(verdict);
    }
    return SMP_DONE;
}

static bool is_same_upload(const struct smp_request *request)
{
    const struct upload *upload = &server.upload;

    return upload->open && upload->has_sha && request->has_len && request->len == upload->size &&
           request->sha.value != NULL && request->sha.len == sizeof upload->sha &&
           memcmp(request->sha.value, upload->sha, sizeof upload->sha) == 0;
}

static struct smp_result upload(const struct smp_request *request, zcbor_state_t *response)
{
    struct upload *upload = &server.upload;
    struct smp_result result = SMP_DONE;
    bool fits;

    if (!request->has_off || request->data.value == NULL)
        return smp_refuse(SMP_INVALID, "no offset, or no data");
    if (request->off == 0 && !is_same_upload(request))
        result = begin(request);
    if (result.code != SMP_OK)
        return result;
    if (!upload->open)
        return smp_refuse(SMP_BAD_STATE, "no upload was begun");
    /* What is not the next piece changes nothing; the answer says which is. */
    if (request->off == upload->offset) {
        if (request->data.len > upload->size - upload->offset)
            return smp_refuse(SMP_INVALID, "more data than announced");
        if (!store(request->data.value, request->data.len)) {
            upload->open = false;
            return flash_failed();
        }
        if (upload->offset == upload->size)
            result = finish();
    }
    if (result.code != SMP_OK)
        return result;
    fits = zcbor_tstr_put_lit(response, "off") && zcbor_uint32_put(response, upload->offset) &&
           (upload->open || !upload->has_sha || put_truth(response, "match", true));
    return fits ? SMP_DONE : smp_refuse(SMP_INVALID, "response too long");
}

/* Slot 1 unless the request says which; never the one to fall back to. */
static struct smp_result erase(const struct smp_request *request)
{
    const uint32_t slot = request->has_slot ? request->slot : 1;
    struct slot slots[SLOT_COUNT];

    if (slot >= SLOT_COUNT)
        return smp_refuse(SMP_INVALID, "no such slot");
    read_slots(slots);
    if ((int)slot == slot_keep(slots, valid_slots()))
        return smp_refuse(SMP_BAD_STATE, "image is in use");
    if (server.upload.slot == (int)slot)
        server.upload.open = false;
    return discard((int)slot) ? SMP_DONE : flash_failed();
}

struct smp_result smp_image(const struct smp_request *request, zcbor_state_t *response)
{
    switch (request->command) {
    case STATE:
        return request->write ? set_state(request, response) : list(response);
    case UPLOAD:
        if (request->write)
            return upload(request, response);
        break;
    case ERASE:
        if (request->write)
            return erase(request);
        break;
    default:
        break;
    }
    return smp_refuse(SMP_NOT_SUPPORTED, "no such command");
}
