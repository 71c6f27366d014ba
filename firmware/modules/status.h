/* SPDX-License-Identifier: BSD-2-Clause */
/** What the axes are doing: STATUS, RDSTAT, RDSBYTE, MOTCTRL, TICK. */
#ifndef MODULES_STATUS_H
#define MODULES_STATUS_H

#include "core/module.h"

extern const struct module status_module;

/** The byte of RDSTAT and RDSBYTE. */
uint8_t status_byte(unsigned axis);

/**
 * What the original shows to the left of an axis' position: U or L at a limit switch or a soft
 * limit, D disabled, or a blank.
 */
char status_limit_letter(unsigned axis);

#endif
