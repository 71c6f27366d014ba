/* SPDX-License-Identifier: BSD-2-Clause */
/** VECTOR: closed-loop motion at a constant velocity, until a limit. Not busy. */
#ifndef MODULES_VECTOR_H
#define MODULES_VECTOR_H

#include "core/module.h"

extern const struct module vector_module;

#endif
