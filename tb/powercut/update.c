/* SPDX-License-Identifier: BSD-2-Clause */
/* Updates, by the boot program's core: images from imgtool (tb/firmware/boot_images.py) through its SMP server. */
#include <stdio.h>
#include <string.h>

#include "boot/counter.h"
#include "boot/smp.h"
#include "boot/start.h"
#include "chip.h"
#include "image_file.h"
#include "scenario.h"

enum { PIECE = 400, STARTS = 3, COUNTS = 511 /* that leave a sector of the counter one */ };

static uint8_t memory[IMAGE_RAM_BYTES];
static struct image image;

static bool put(const char *name, int slot)
{
    static uint8_t bytes[IMAGE_FILE_BYTES];

    return flash_program(slot_address(slot), bytes, image_file_read(name, bytes));
}

static bool start(void)
{
    return start_load(memory, &image) != SLOT_NONE;
}

/* --- the host's side of SMP ---------------------------------------------------------------------------------- */

static struct zcbor_string bytes_of(const void *bytes, size_t size)
{
    return (struct zcbor_string){.value = bytes, .len = size};
}

static bool put_bytes(zcbor_state_t *map, const char *key, const void *bytes, size_t size)
{
    const struct zcbor_string string = bytes_of(bytes, size);

    return zcbor_tstr_encode_ptr(map, key, strlen(key)) && zcbor_bstr_encode(map, &string);
}

static bool put_number(zcbor_state_t *map, const char *key, uint32_t number)
{
    return zcbor_tstr_encode_ptr(map, key, strlen(key)) && zcbor_uint32_put(map, number);
}

/* A written request of group 1, whose map ends at `end`. False: refused. */
static bool ask(uint8_t command, uint8_t *request, const uint8_t *end)
{
    uint8_t response[1024];
    const size_t size = (size_t)(end - request) - 8;
    const uint8_t header[8] = {2, 0, (uint8_t)(size >> 8), (uint8_t)size, 0, 1, 0, command};
    size_t length;

    memcpy(request, header, sizeof header);
    length = smp_handle(request, size + 8, response, sizeof response);
    return length > 0 && memmem(response, length, "\x62rc", 3) == NULL;
}

static bool send(const char *name)
{
    static uint8_t bytes[IMAGE_FILE_BYTES];
    const size_t size = image_file_read(name, bytes);
    uint8_t request[PIECE + 100];

    smp_init(memory, SLOT_NONE);
    for (size_t at = 0; at < size; at += PIECE) {
        const size_t piece = size - at < PIECE ? size - at : PIECE;
        ZCBOR_STATE_E(map, 2, request + 8, sizeof request - 8, 1);

        if (!zcbor_map_start_encode(map, 4) || !put_number(map, "off", (uint32_t)at) ||
            (at == 0 && !put_number(map, "len", (uint32_t)size)) || !put_bytes(map, "data", bytes + at, piece) ||
            !zcbor_map_end_encode(map, 4) || !ask(1, request, map->payload))
            return false;
    }
    return true;
}

/* Test the image of a slot, or confirm it, which is the one that runs if `runs`. */
static bool set_state(int slot, bool confirm, bool runs)
{
    uint8_t request[150];
    ZCBOR_STATE_E(map, 2, request + 8, sizeof request - 8, 1);

    if (image_load(slot_address(slot), SLOT_IMAGE_BYTES, 0, memory, &image) != IMAGE_VALID)
        return false;
    smp_init(memory, runs ? slot : SLOT_NONE);
    return zcbor_map_start_encode(map, 2) && put_bytes(map, "hash", image.hash, image.hash_bytes) &&
           zcbor_tstr_put_lit(map, "confirm") && zcbor_bool_put(map, confirm) && zcbor_map_end_encode(map, 2) &&
           ask(0, request, map->payload);
}

/* --- what is kept and runs ------------------------------------------------------------------------------------ */

static char *tell_version(char *at)
{
    const struct image_version *version = &image.version;

    return at + sprintf(at, " %u.%u.%u+%u", version->major, version->minor, version->revision, version->build);
}

/* What the counter has, whether slot 1 holds an image, and what the next starts start, if nobody confirms it. */
static void tell(char *state)
{
    char *at = state + sprintf(state, "counter %x, slot 1:", counter_read());

    if (image_load(slot_address(1), SLOT_IMAGE_BYTES, counter_read(), memory, &image) == IMAGE_VALID)
        at = tell_version(at);
    at += sprintf(at, ", starts:");
    for (unsigned n = 0; n < STARTS; n++)
        at = start() ? tell_version(at) : at + sprintf(at, " nothing");
}

/* --- scenarios ------------------------------------------------------------------------------------------------- */

/* 1.0.0 is confirmed and has been started; the other slot has seen an older one. */
static bool prepare_one(void)
{
    return put("good", 0) && slot_select(0, true) && put("older", 1) && slot_select(1, false) && slot_mark_tried(1) && start();
}

static bool upload(void)
{
    return send("newer");
}

static bool discard(void)
{
    return slot_unselect(1) && flash_erase(slot_address(1));
}

static bool prepare_two(void)
{
    return prepare_one() && upload();
}

static bool test(void)
{
    return set_state(1, false, false);
}

static bool confirm_unseen(void)
{
    return set_state(1, true, false);
}

static bool prepare_test(void)
{
    return prepare_two() && test();
}

static bool prepare_tried(void)
{
    return prepare_test() && start();
}

static bool confirm(void)
{
    return slot_read(1).state == SLOT_CONFIRMED || set_state(1, true, true);
}

static bool prepare_confirmed(void)
{
    return prepare_tried() && confirm();
}

/* The first version takes the last place of the counter's sector, the next goes to the other. */
static bool prepare_counter_full(void)
{
    for (uint32_t n = 1; n <= COUNTS; n++)
        counter_raise(n);
    return counter_read() == COUNTS && prepare_two() && confirm_unseen();
}

/* Two of one version, the second confirmed; back to the first. */
static bool prepare_rebuilt(void)
{
    return prepare_one() && send("rebuilt") && confirm_unseen() && start();
}

static bool go_back(void)
{
    return set_state(0, true, false);
}

#define V0 "1.0.0+0"
#define V1 "1.0.1+7"
#define STATE(counter, other, first, then) "counter " counter ", slot 1:" other ", starts: " first " " then " " then

const struct scenario scenario_update[] = {
    {"upload", prepare_one, upload, tell, discard, STATE("1000000", "", V0, V0), STATE("1000000", " " V1, V0, V0), 3},
    {"select for a test", prepare_two, test, tell, NULL, STATE("1000000", " " V1, V0, V0), STATE("1000000", " " V1, V1, V0), 1},
    {"select for good", prepare_two, confirm_unseen, tell, NULL, STATE("1000000", " " V1, V0, V0),
     STATE("1000000", " " V1, V1, V1), 1},
    {"start a test", prepare_test, start, tell, NULL, STATE("1000000", " " V1, V1, V0), STATE("1000000", " " V1, V0, V0), 0},
    {"confirm", prepare_tried, confirm, tell, NULL, STATE("1000000", " " V1, V0, V0), STATE("1000000", " " V1, V1, V1), 0},
    {"start what is confirmed", prepare_confirmed, start, tell, NULL, STATE("1000000", " " V1, V1, V1),
     STATE("1000001", " " V1, V1, V1), 0},
    {"start what is confirmed, counter full", prepare_counter_full, start, tell, NULL, STATE("1000000", " " V1, V1, V1),
     STATE("1000001", " " V1, V1, V1), 1},
    {"go back", prepare_rebuilt, go_back, tell, NULL, STATE("1000000", " 1.0.0+9", "1.0.0+9", "1.0.0+9"),
     STATE("1000000", " 1.0.0+9", V0, V0), 1},
    {0},
};
