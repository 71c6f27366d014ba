/* SPDX-License-Identifier: BSD-2-Clause */
#include "boot_images.h"

#include <string.h>

#include "boot/slot.h"
#include "image_file.h"
#include "nor_flash.h"

uint8_t boot_memory[IMAGE_RAM_BYTES];

void boot_image_put(const char *name, int slot)
{
    static uint8_t bytes[IMAGE_FILE_BYTES];
    const size_t size = image_file_read(name, bytes);

    memset(nor_flash + slot_address(slot), 0xff, SLOT_IMAGE_BYTES);
    memcpy(nor_flash + slot_address(slot), bytes, size);
}
