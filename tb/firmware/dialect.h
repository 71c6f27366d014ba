/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * The same line as other hosts would say it: numbers with exponents, no blanks between arguments,
 * CR twice. With DIALECT in the environment all tests speak so (test_host.py).
 */
#ifndef TB_FIRMWARE_DIALECT_H
#define TB_FIRMWARE_DIALECT_H

#include <stddef.h>

/** Write the line with its CR; `size` must be four times its length and more. Returns its length. */
size_t dialect_write(const char *line, char *text, size_t size);

#endif
