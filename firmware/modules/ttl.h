/* SPDX-License-Identifier: BSD-2-Clause */
/** TTL: the mode of the input IN0, the output OUT0, and the polarity of the outputs. */
#ifndef MODULES_TTL_H
#define MODULES_TTL_H

#include "core/module.h"

extern const struct module ttl_module;

#endif
