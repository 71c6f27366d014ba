/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Unsolicited lines: what the controller says without being asked, sent by the console between
 * replies. Main loop only.
 *
 * A line waits whole or not at all: one that finds no room is dropped and logged as
 * FAULT_REPORT_OVERRUN.
 */
#ifndef CORE_REPORT_H
#define CORE_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { REPORT_BYTES = 256 };

/** Send a line; its end, as replies have it, is added. */
void report_line(const char *text, size_t length);

/** Room, in bytes; and send so many bytes as they are. */
size_t report_free(void);
void report_bytes(const uint8_t *bytes, size_t length);

/** Drop what waits: start-up and RESET. */
void report_clear(void);

/** For the console. */
bool report_take(uint8_t *byte);
bool report_is_empty(void);

#endif
