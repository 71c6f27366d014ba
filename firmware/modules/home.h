/* SPDX-License-Identifier: BSD-2-Clause */
/** HOME and where it goes to: SETHOME. */
#ifndef MODULES_HOME_H
#define MODULES_HOME_H

#include "core/module.h"

extern const struct module home_module;

#endif
