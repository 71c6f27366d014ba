/* SPDX-License-Identifier: BSD-2-Clause */
/** What the TTL connectors IN0 and OUT0 do: TTL, and the times RTIME X and Y. */
#ifndef MODULES_TTL_H
#define MODULES_TTL_H

#include "core/module.h"

extern const struct module ttl_module;

/** Do what a pulse at IN0 does in the present mode: bare RM. Always true. */
bool ttl_trigger(void);

#endif
