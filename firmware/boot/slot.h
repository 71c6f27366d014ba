/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The two slots for images, and which of them is started: the trailer flags of MCUboot, without moving images.
 *
 * A trailer is the end of the last sector of its slot, flags 8 bytes apart as imgtool writes them for --max-align 8:
 *
 *     from the end   bytes   what
 *     -48            8       generation (boot/sealed.h): which slot was selected last; erased means 0
 *     -32            1       copy_done: 1 = the image was started once
 *     -24            1       image_ok: 1 = confirmed
 *     -16            16      magic: selected; without it the rest means nothing
 *
 * It is written from the top down, so that the magic, last, makes it true at once. Three changes there are: selecting
 * (erase, generation, magic), starting a test (copy_done), confirming (image_ok); a revert writes nothing.
 */
#ifndef BOOT_SLOT_H
#define BOOT_SLOT_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/flash_map.h"

enum {
    SLOT_COUNT = FLASH_MAP_SLOT_COUNT,
    SLOT_NONE = -1,
    SLOT_IMAGE_BYTES = FLASH_MAP_SLOT_SIZE - FLASH_SECTOR, /* room before the trailer's sector */
};

enum slot_state {
    SLOT_UNSELECTED, /* not to be started */
    SLOT_PENDING,    /* to be started once, as a test */
    SLOT_TRIED,      /* was started and has not been confirmed: not to be started again */
    SLOT_CONFIRMED,
};

struct slot {
    enum slot_state state;
    uint32_t generation;
};

/** Where the image of a slot begins in flash. */
uint32_t slot_address(int slot);

/** Read a trailer, once. A slot that cannot be read is unselected. */
struct slot slot_read(int slot);

/**
 * Which slot is to be started: of those pending or confirmed the one selected last.
 *
 * @param skip  Bit n: not slot n.
 * @return      SLOT_NONE if none.
 */
int slot_choose(const struct slot slots[SLOT_COUNT], unsigned skip);

/** Which slot an upload must not touch, of those in `valid` (bit n: slot n), the best to fall back to; SLOT_NONE. */
int slot_keep(const struct slot slots[SLOT_COUNT], unsigned valid);

/** Let a slot be started next: once, to be confirmed (`permanent` false), or from now on. False: not written. */
bool slot_select(int slot, bool permanent);

/** Note that a pending image is about to be started. False: not written, so it must not be. */
bool slot_mark_tried(int slot);

/** Confirm a pending or tried image. False: not written, or neither. */
bool slot_confirm(int slot);

/** Take the selection away. False: not written. */
bool slot_unselect(int slot);

#endif
