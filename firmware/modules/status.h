/* SPDX-License-Identifier: BSD-2-Clause */
/** What the axes are doing: STATUS, RDSTAT, RDSBYTE, MOTCTRL, TICK. */
#ifndef MODULES_STATUS_H
#define MODULES_STATUS_H

#include "core/module.h"

extern const struct module status_module;

#endif
