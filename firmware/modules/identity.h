/* SPDX-License-Identifier: BSD-2-Clause */
/** Who and what this controller is: VERSION, WHO, BUILD, CDATE. */
#ifndef MODULES_IDENTITY_H
#define MODULES_IDENTITY_H

#include "core/module.h"

extern const struct module identity_module;

#endif
