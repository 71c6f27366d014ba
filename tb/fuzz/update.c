/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Fuzz target: what reaches the boot program from outside. Linked with libFuzzer, or with replay.c. The first byte says what the
 * rest is:
 *
 *     'L'   bytes on the serial line
 *     'P'   SMP packets, each after its length (2 bytes, high first)
 *     'I'   an image in a slot that is selected, behind the header and first words of one
 *
 * Claims, beside what the sanitizers see: an answer fits and is as long as it says, nothing outside the slots is written, and
 * nothing that comes so is started.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boot/frame.h"
#include "boot/image.h"
#include "boot/smp.h"
#include "boot/start.h"
#include "nor_flash.h"
#include "regs.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { TOUCHED_BYTES = 0x4000, SEALED_PROGRAM = 16 };

static uint8_t memory[IMAGE_RAM_BYTES];
static uint8_t response[FRAME_PACKET_BYTES];

static void claim(bool holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "%s\n", what);
        abort();
    }
}

/* Inputs are short, so that they reach the first sectors of a slot and its trailer only. */
static void erase_touched(void)
{
    static bool erased;

    if (!erased)
        nor_flash_reset();
    erased = true;
    for (int slot = 0; slot < SLOT_COUNT; slot++) {
        memset(nor_flash + slot_address(slot), 0xff, TOUCHED_BYTES);
        memset(nor_flash + slot_address(slot) + SLOT_IMAGE_BYTES, 0xff, FLASH_SECTOR);
    }
}

/* The counter's sectors, and the first of what lies behind the slots. */
static bool flash_is_untouched(void)
{
    for (uint32_t n = 0; n < FLASH_SECTOR; n++)
        if ((nor_flash[FLASH_MAP_COUNTER + n] & nor_flash[FLASH_MAP_GUARDED_END - 1 - n] & nor_flash[FLASH_MAP_SETTINGS + n]) != 0xff)
            return false;
    return true;
}

static void handle(const uint8_t *packet, size_t size)
{
    const size_t answer = smp_handle(packet, size, response, sizeof response);

    claim(answer <= sizeof response, "an answer that does not fit");
    claim(answer == 0 || (answer >= 8 && answer == 8 + ((size_t)response[2] << 8 | response[3])), "an answer of another length");
}

static void line(const uint8_t *data, size_t size)
{
    static struct frame frame;

    memset(&frame, 0, sizeof frame);
    for (size_t n = 0; n < size; n++) {
        const uint8_t *packet;
        const size_t length = frame_take(&frame, data[n], &packet);

        claim(length <= FRAME_PACKET_BYTES, "a packet that does not fit");
        if (length != 0)
            handle(packet, length);
    }
}

static void packets(const uint8_t *data, size_t size)
{
    while (size >= 2) {
        size_t length = (size_t)data[0] << 8 | data[1];

        data += 2;
        size -= 2;
        length = length > size ? size : length;
        handle(data, length);
        data += length;
        size -= length;
    }
}

static void put32(uint8_t *to, uint32_t value)
{
    for (unsigned n = 0; n < 4; n++)
        to[n] = (uint8_t)(value >> 8 * n);
}

/* The header says that the program is 16 bytes, so that the input is TLVs; its first two bytes change one of these. */
static void image(const uint8_t *data, size_t size)
{
    uint8_t *at = nor_flash + slot_address(0);
    struct image found;

    put32(at, 0x96f3b83d);
    put32(at + 4, IMAGE_RAM);
    put32(at + 8, IMAGE_HEADER_BYTES);
    put32(at + 12, SEALED_PROGRAM);
    put32(at + 16, 0x20);
    memset(at + 20, 0, 12 + SEALED_PROGRAM);
    put32(at + 36, IMAGE_MARK);
    put32(at + 40, IMAGE_PRODUCT);
    put32(at + 44, REG_MAP_VERSION);
    if (size >= 2) {
        at[data[0] % IMAGE_START_BYTES] ^= data[1];
        memcpy(at + IMAGE_START_BYTES, data + 2, size - 2 < TOUCHED_BYTES / 2 ? size - 2 : TOUCHED_BYTES / 2);
    }
    slot_select(0, true);
    claim(start_load(memory, &found) == SLOT_NONE, "an image without a signature is started");
    claim(!image_is_application(memory), "what was refused could be taken for an application");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct image found;

    if (size == 0 || size > TOUCHED_BYTES / 4)
        return 0;
    erase_touched();
    memset(memory, 0, IMAGE_START_BYTES);
    smp_init(memory, data[0] == 'P' && (data[size - 1] & 1u) != 0 ? 0 : SLOT_NONE);
    if (data[0] == 'L')
        line(data + 1, size - 1);
    else if (data[0] == 'P')
        packets(data + 1, size - 1);
    else if (data[0] == 'I')
        image(data + 1, size - 1);
    claim(start_load(memory, &found) == SLOT_NONE, "something is started that nobody signed");
    claim(flash_is_untouched(), "bytes outside the slots were written");
    return 0;
}
