/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The downgrade counter: the image_counter of the newest image that was confirmed, which no older one may follow.
 *
 * It lies in the guarded part of the flash, so that only the boot program can write it, after power-up. Two sectors of
 * sealed numbers (boot/sealed.h), the largest of which counts; when one is full the other is erased and goes on.
 */
#ifndef BOOT_COUNTER_H
#define BOOT_COUNTER_H

#include <stdint.h>

/** The smallest image_counter that may be started; 0 if nothing was ever confirmed. */
uint32_t counter_read(void);

/** Never go back behind `value` again. Does nothing when it is not larger; may fail, and will be tried at the next start. */
void counter_raise(uint32_t value);

#endif
