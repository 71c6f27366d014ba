/* SPDX-License-Identifier: BSD-2-Clause */
/** What is where in the flash memory, in bytes; docs/boot.md draws it. */
#ifndef HAL_FLASH_MAP_H
#define HAL_FLASH_MAP_H

#include "hal/flash.h"

enum {
    /* Below this nothing can be erased or programmed after flash_lock: bitstreams, which never can, and counter. */
    FLASH_MAP_GUARDED_END = 0x400000,

    /* Oldest version that may be started, two sectors: boot/counter.h. */
    FLASH_MAP_COUNTER = 0x3fe000,

    /* Application images, each with its trailer in its last sector: boot/slot.h. */
    FLASH_MAP_SLOTS = 0x400000,
    FLASH_MAP_SLOT_SIZE = 0x80000,
    FLASH_MAP_SLOT_COUNT = 2,

    /* File system of the settings. */
    FLASH_MAP_SETTINGS = 0x500000,
    FLASH_MAP_SETTINGS_SECTORS = 64,
};

#endif
