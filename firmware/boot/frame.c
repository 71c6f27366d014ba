/* SPDX-License-Identifier: BSD-2-Clause */
#include "boot/frame.h"

enum {
    BETWEEN,       /* lines */
    AFTER_FIRST,   /* 06 came */
    AFTER_MORE,    /* 04 came */
    IN_LINE,
    FIRST_0 = 0x06,
    FIRST_1 = 0x09,
    MORE_0 = 0x04,
    MORE_1 = 0x14,
    LINE_BYTES = 93, /* of a packet in one line: 124 characters, and with the rest of the line 127 */
    NO_SEXTET = -1,
};

uint16_t frame_crc(uint16_t crc, const uint8_t *bytes, size_t size)
{
    for (size_t n = 0; n < size; n++) {
        crc = (uint16_t)(crc ^ bytes[n] << 8);
        for (int bit = 0; bit < 8; bit++)
            crc = (uint16_t)(crc << 1 ^ ((crc & 0x8000) != 0 ? 0x1021 : 0));
    }
    return crc;
}

static int sextet(uint8_t character)
{
    if (character >= 'A' && character <= 'Z')
        return character - 'A';
    if (character >= 'a' && character <= 'z')
        return character - 'a' + 26;
    if (character >= '0' && character <= '9')
        return character - '0' + 52;
    return character == '+' ? 62 : character == '/' ? 63 : NO_SEXTET;
}

/* A character of base64; '=' stands for six bits that give no byte. */
static void take_character(struct frame *frame, uint8_t character)
{
    const bool padding = character == '=' && frame->phase >= 2;
    const int value = padding ? 0 : sextet(character);

    if (value == NO_SEXTET || (frame->ended && !padding)) {
        frame->open = false;
        return;
    }
    frame->ended = frame->ended || padding;
    frame->sextets = frame->sextets << 6 | (uint32_t)value;
    if (++frame->phase < 2 || padding) {
        frame->phase &= 3u;
        return;
    }
    if (frame->count == sizeof frame->bytes) {
        frame->open = false;
        return;
    }
    /* With the n-th character the (n - 1)-th byte of three is whole. */
    frame->bytes[frame->count++] = (uint8_t)(frame->sextets >> (8 - 2 * frame->phase));
    frame->phase &= 3u;
}

/* At the end of a line: the packet's length if it is whole. */
static size_t packet_size(const struct frame *frame)
{
    size_t size;

    if (!frame->open || frame->phase != 0 || frame->count < FRAME_LENGTH_BYTES + FRAME_CRC_BYTES)
        return 0;
    size = (size_t)frame->bytes[0] << 8 | frame->bytes[1];
    if (size < FRAME_CRC_BYTES || frame->count != FRAME_LENGTH_BYTES + size)
        return 0;
    /* The CRC of a packet with its CRC behind it is 0. */
    return frame_crc(0, frame->bytes + FRAME_LENGTH_BYTES, size) == 0 ? size - FRAME_CRC_BYTES : 0;
}

static void start_packet(struct frame *frame)
{
    frame->count = 0;
    frame->phase = 0;
    frame->open = true;
    frame->ended = false;
}

size_t frame_take(struct frame *frame, uint8_t byte, const uint8_t **packet)
{
    size_t size;

    switch (frame->state) {
    case AFTER_FIRST:
    case AFTER_MORE:
        if (byte == (frame->state == AFTER_FIRST ? FIRST_1 : MORE_1)) {
            if (frame->state == AFTER_FIRST)
                start_packet(frame);
            frame->state = IN_LINE;
            return 0;
        }
        break;
    case IN_LINE:
        if (byte == '\r')
            return 0;
        if (byte != '\n') {
            if (frame->open)
                take_character(frame, byte);
            return 0;
        }
        frame->state = BETWEEN;
        size = packet_size(frame);
        if (size != 0) {
            *packet = frame->bytes + FRAME_LENGTH_BYTES;
            frame->open = false; /* nothing continues it */
        }
        return size;
    default:
        break;
    }
    frame->state = byte == FIRST_0 ? AFTER_FIRST : byte == MORE_0 ? AFTER_MORE : BETWEEN;
    return 0;
}

static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/* Four characters for up to three bytes. */
static void put_group(const uint8_t *bytes, unsigned count, void (*put)(uint8_t byte))
{
    const uint32_t value = (uint32_t)bytes[0] << 16 | (uint32_t)bytes[1] << 8 | bytes[2];

    for (unsigned n = 0; n < 4; n++)
        put(n <= count ? (uint8_t)alphabet[value >> (18 - 6 * n) & 63u] : '=');
}

void frame_send(const uint8_t *packet, size_t size, void (*put)(uint8_t byte))
{
    const uint16_t crc = frame_crc(0, packet, size);
    const size_t framed = size + FRAME_CRC_BYTES, total = FRAME_LENGTH_BYTES + framed;
    uint8_t group[3] = {0};
    unsigned count = 0;

    for (size_t n = 0; n < total; n++) {
        if (n % LINE_BYTES == 0) {
            put(n == 0 ? FIRST_0 : MORE_0);
            put(n == 0 ? FIRST_1 : MORE_1);
        }
        if (n < FRAME_LENGTH_BYTES)
            group[count++] = (uint8_t)(framed >> (8 - 8 * n));
        else if (n < FRAME_LENGTH_BYTES + size)
            group[count++] = packet[n - FRAME_LENGTH_BYTES];
        else
            group[count++] = (uint8_t)(crc >> (n == total - 1 ? 0 : 8));
        if (count == sizeof group || n == total - 1) {
            put_group(group, count, put);
            group[0] = group[1] = group[2] = 0;
            count = 0;
        }
        if ((n + 1) % LINE_BYTES == 0 || n == total - 1)
            put('\n');
    }
}
