/* SPDX-License-Identifier: BSD-2-Clause */
#include "boot_images.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "boot/slot.h"
#include "nor_flash.h"

uint8_t boot_memory[IMAGE_RAM_BYTES];

size_t boot_image_read(const char *name, uint8_t bytes[IMAGE_FILE_BYTES])
{
    char path[1024];
    FILE *file;
    size_t size;

    snprintf(path, sizeof path, IMAGES "/%s.bin", name);
    file = fopen(path, "rb");
    if (file == NULL) {
        perror(path);
        exit(2);
    }
    size = fread(bytes, 1, IMAGE_FILE_BYTES, file);
    fclose(file);
    return size;
}

void boot_image_put(const char *name, int slot)
{
    static uint8_t bytes[IMAGE_FILE_BYTES];
    const size_t size = boot_image_read(name, bytes);

    memset(nor_flash + slot_address(slot), 0xff, SLOT_IMAGE_BYTES);
    memcpy(nor_flash + slot_address(slot), bytes, size);
}
