/* SPDX-License-Identifier: BSD-2-Clause */
/** The application's part in updates: it asks the boot program for one, and confirms itself when it is new and well. */
#ifndef MODULES_UPDATE_H
#define MODULES_UPDATE_H

#include <stdbool.h>

#include "core/module.h"

/** A new image is confirmed when the main loop has turned for so long. */
enum { UPDATE_CONFIRM_S = 10 };

/** BU R. */
extern const struct module update_module;

/** From the acknowledge of BU R=1 on: nothing is to be carried out any more. */
bool update_is_wanted(void);

/** Leave for the boot program's update server. Returns only where there is no processor to reset. */
void update_enter(void);

/** Version of the boot program that started this, 0 if none did. */
unsigned update_boot_version(void);

#endif
