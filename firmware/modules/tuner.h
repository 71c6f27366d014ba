/* SPDX-License-Identifier: BSD-2-Clause */
/** AZERO: measures the motor of an axis by steps of drive and gives the axis its gains. */
#ifndef MODULES_TUNER_H
#define MODULES_TUNER_H

#include "core/module.h"

extern const struct module tuner_module;

#endif
