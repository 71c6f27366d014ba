/* SPDX-License-Identifier: BSD-2-Clause */
/** INFO: all about an axis on one page, for a person and for hosts that read it by columns. */
#ifndef MODULES_INFO_H
#define MODULES_INFO_H

#include "core/module.h"

extern const struct module info_module;

#endif
