/* SPDX-License-Identifier: BSD-2-Clause */
/** Z-stack: slices of the focus axis, one a pulse at IN0 (TTL X=4). ZS. */
#ifndef MODULES_Z_STACK_H
#define MODULES_Z_STACK_H

#include "core/module.h"

extern const struct module z_stack_module;

/** Number of the present slice, from 0: ZS T?. */
unsigned z_stack_slice(void);

/* For the table in ttl_modes.c. A pulse: the first goes to the first slice, each further one to the
 * next. */
struct ttl_step;
bool z_stack_step(struct ttl_step *step);
void z_stack_stepped(void);

#endif
