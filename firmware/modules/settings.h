/* SPDX-License-Identifier: BSD-2-Clause */
/** SAVESET. */
#ifndef MODULES_SETTINGS_H
#define MODULES_SETTINGS_H

#include "core/module.h"

extern const struct module settings_module;

#endif
