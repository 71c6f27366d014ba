/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Back end of the settings for the host build: a text file, one `key value` a line, the value in
 * C's hexadecimal floating-point form, so that it reads back bit for bit.
 *
 * `commit` writes a new file beside the old one and renames it: the file on disk is always whole.
 */
#ifndef HOST_SETTINGS_FILE_H
#define HOST_SETTINGS_FILE_H

#include "core/settings.h"

/**
 * The store over a file, read now; one that is not there yet is empty. Lines it does not
 * understand are dropped, and the store is damaged until the next commit. One store a process.
 */
const struct settings_store *settings_file(const char *path);

#endif
