/* SPDX-License-Identifier: BSD-2-Clause */
/**
 * SMP packets on a serial line: lines of base64, the first of a packet begins with 06 09 and the others with 04 14, all
 * end with LF. Inside: length of what follows (2 bytes, high first), packet, CRC-16 of the packet (XMODEM, high first).
 */
#ifndef BOOT_FRAME_H
#define BOOT_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    FRAME_PACKET_BYTES = 1024, /* longest packet taken or sent */
    FRAME_LENGTH_BYTES = 2,
    FRAME_CRC_BYTES = 2,
};

/** Bytes to packets. All zero at the start. */
struct frame {
    uint8_t bytes[FRAME_LENGTH_BYTES + FRAME_PACKET_BYTES + FRAME_CRC_BYTES];
    size_t count;     /* of them, of this packet so far */
    uint32_t sextets; /* not yet a byte */
    uint8_t phase;    /* how many of four characters there are */
    uint8_t state;
    bool open;        /* a packet was begun and what came of it is sound; otherwise its lines are dropped */
    bool ended;       /* padding was seen */
};

/**
 * Take one byte from the line.
 *
 * @return  The length of a packet that it completes, which is at `*packet` until the next byte; otherwise 0. What is no
 *          whole packet, with the right CRC, is dropped in silence.
 */
size_t frame_take(struct frame *frame, uint8_t byte, const uint8_t **packet);

/** Write a packet's lines with `put`. */
void frame_send(const uint8_t *packet, size_t size, void (*put)(uint8_t byte));

/** CRC-16/XMODEM: polynomial 1021, from 0. */
uint16_t frame_crc(uint16_t crc, const uint8_t *bytes, size_t size);

#endif
