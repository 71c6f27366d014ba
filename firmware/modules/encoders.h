/* SPDX-License-Identifier: BSD-2-Clause */
/** Encoders: their direction (EPOLARITY), and what happens when one cannot be believed. */
#ifndef MODULES_ENCODERS_H
#define MODULES_ENCODERS_H

#include "core/module.h"

extern const struct module encoders_module;

#endif
