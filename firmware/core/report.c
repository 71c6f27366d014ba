/* SPDX-License-Identifier: BSD-2-Clause */
#include "core/report.h"

#include "core/fault.h"
#include "core/reply.h"
#include "core/ring.h"

RING_DEFINE(waiting, REPORT_BYTES);

void report_line(const char *text, size_t length)
{
    if (ring_free(&waiting) < length + 2) {
        log_error(FAULT_REPORT_OVERRUN);
        return;
    }
    for (size_t i = 0; i < length; i++)
        ring_put(&waiting, (uint8_t)text[i]);
    ring_put(&waiting, '\r');
    if (!reply_ends_in_cr)
        ring_put(&waiting, '\n');
}

size_t report_free(void)
{
    return ring_free(&waiting);
}

void report_bytes(const uint8_t *bytes, size_t length)
{
    for (size_t i = 0; i < length; i++)
        ring_put(&waiting, bytes[i]);
}

void report_clear(void)
{
    ring_clear(&waiting);
}

bool report_take(uint8_t *byte)
{
    return ring_take(&waiting, byte);
}

bool report_is_empty(void)
{
    return ring_used(&waiting) == 0;
}
