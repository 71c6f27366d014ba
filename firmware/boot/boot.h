/* SPDX-License-Identifier: BSD-2-Clause */
/** What boot.S calls. */
#ifndef BOOT_BOOT_H
#define BOOT_BOOT_H

/** As BUILD X of the application prints it. */
#define BOOT_VERSION 1u

/** After every reset, with memory set up. Does not return. */
void boot_main(void);

/** An exception, which is a bug. Does not return. */
void boot_trap(void);

#endif
