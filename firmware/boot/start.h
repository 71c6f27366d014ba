/* SPDX-License-Identifier: BSD-2-Clause */
/** From two slots to a verified program in RAM. */
#ifndef BOOT_START_H
#define BOOT_START_H

#include "boot/image.h"
#include "boot/slot.h"

/**
 * Load the image that is to be started and note that it is: a pending one has had its test then, and the version of a
 * confirmed one is the oldest from now on.
 *
 * @param memory  IMAGE_RAM_BYTES.
 * @param image   What was loaded.
 * @return        Its slot, or SLOT_NONE: no selected slot holds a valid image, and what is in `memory` is not to be started.
 */
int start_load(uint8_t *memory, struct image *image);

#endif
