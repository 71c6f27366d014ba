/* SPDX-License-Identifier: BSD-2-Clause */
/** What boot.S calls, and has. */
#ifndef BOOT_BOOT_H
#define BOOT_BOOT_H

/** As BUILD X of the application prints it. */
#define BOOT_VERSION 1u

#include <stdint.h>

/** After every reset, with memory set up. Does not return. */
void boot_main(void);

/** An exception, which is a bug. Does not return. */
void boot_trap(void);

/** Go on at an address, where a program has been put. Does not return. */
void boot_run(uint32_t address);

#endif
