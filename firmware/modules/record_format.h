/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * Records of positions as they go over the line: docs/modules/ttl_report.md has every byte. Pure, and
 * quick enough for an interrupt: no division but by constants, no double.
 */
#ifndef MODULES_RECORD_FORMAT_H
#define MODULES_RECORD_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/axis.h"

enum record_format {
    RECORD_BINARY,   /* as the original: address and count of each axis, CR */
    RECORD_ASCII,    /* X=1 Y=-2 CR LF */
    RECORD_EXTENDED, /* AA 55, length, number, time, counts, CRC */
    RECORD_FORMATS,
};

/** Bytes of the longest record: four counts of eleven characters in ASCII. */
enum { RECORD_BYTES_MAX = 60 };

struct record {
    uint64_t time_fast;
    uint16_t number;              /* counts up and wraps */
    uint8_t address[AXIS_COUNT];  /* of the axes in the low-level format */
    int32_t counts[AXIS_COUNT];
};

/** Write a record into `bytes`, which has room for RECORD_BYTES_MAX; its length. */
size_t record_write(uint8_t *bytes, enum record_format format, const struct record *record);

/**
 * The packet of a report on OUT0: places in the array and the Z-stack, counts, and a checksum, all in
 * 16-bit words with the upper byte first, or the lower.
 */
size_t record_write_packet(uint8_t *bytes, bool low_byte_first, const uint16_t place[3],
                           const struct record *record);

/** CRC-16/CCITT-FALSE: polynomial 0x1021, from 0xffff, not reflected, not inverted. */
uint16_t record_crc(const uint8_t *bytes, size_t length);

#endif
