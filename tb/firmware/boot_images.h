/* SPDX-License-Identifier: BSD-2-Clause */
/** Images in the flash of tb/firmware/nor_flash.c, and memory to load them to. */
#ifndef TB_FIRMWARE_BOOT_IMAGES_H
#define TB_FIRMWARE_BOOT_IMAGES_H

#include <stdint.h>

#include "boot/image.h"

/** Put an image into a slot of nor_flash, selecting nothing. */
void boot_image_put(const char *name, int slot);

/** Memory for image_load. */
extern uint8_t boot_memory[IMAGE_RAM_BYTES];

#endif
