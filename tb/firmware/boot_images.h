/* SPDX-License-Identifier: BSD-2-Clause */
/** The images that boot_images.py makes, by name. */
#ifndef TB_FIRMWARE_BOOT_IMAGES_H
#define TB_FIRMWARE_BOOT_IMAGES_H

#include <stddef.h>
#include <stdint.h>

#include "boot/image.h"

/** Read an image into `bytes`; returns its size. Ends the program when there is none of this name. */
size_t boot_image_read(const char *name, uint8_t bytes[IMAGE_FILE_BYTES]);

/** Put an image into a slot of nor_flash, selecting nothing. */
void boot_image_put(const char *name, int slot);

/** Memory for image_load. */
extern uint8_t boot_memory[IMAGE_RAM_BYTES];

#endif
