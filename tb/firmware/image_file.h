/* SPDX-License-Identifier: BSD-2-Clause */
/** The images that boot_images.py makes, by name. */
#ifndef TB_FIRMWARE_IMAGE_FILE_H
#define TB_FIRMWARE_IMAGE_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "boot/image.h"

/** Read an image into `bytes`; returns its size. Ends the program when there is none of this name. */
size_t image_file_read(const char *name, uint8_t bytes[IMAGE_FILE_BYTES]);

#endif
