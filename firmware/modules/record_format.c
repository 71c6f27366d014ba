/* SPDX-License-Identifier: BSD-2-Clause */
#include "modules/record_format.h"

static uint8_t *put_low_first(uint8_t *to, uint64_t value, unsigned size)
{
    for (; size > 0; size--, value >>= 8)
        *to++ = (uint8_t)value;
    return to;
}

static uint8_t *put_decimal(uint8_t *to, int32_t value)
{
    uint8_t digits[10];
    unsigned count = 0;
    uint32_t left = value < 0 ? 0u - (uint32_t)value : (uint32_t)value;

    if (value < 0)
        *to++ = '-';
    do {
        digits[count++] = (uint8_t)('0' + left % 10);
        left /= 10;
    } while (left > 0);
    while (count > 0)
        *to++ = digits[--count];
    return to;
}

static uint8_t *write_binary(uint8_t *to, const struct record *record)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        *to++ = record->address[axis];
        to = put_low_first(to, (uint32_t)record->counts[axis], 4);
    }
    *to++ = '\r';
    return to;
}

static uint8_t *write_ascii(uint8_t *to, const struct record *record)
{
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        if (axis > 0)
            *to++ = ' ';
        *to++ = (uint8_t)AXIS_LETTERS[axis];
        *to++ = '=';
        to = put_decimal(to, record->counts[axis]);
    }
    *to++ = '\r';
    *to++ = '\n';
    return to;
}

static uint8_t *write_extended(uint8_t *to, const struct record *record)
{
    enum { HEAD = 3, NUMBER = 2, TIME = 8, COUNT = 4, CRC = 2 };
    uint8_t *const begin = to;
    uint16_t crc;

    *to++ = 0xaa;
    *to++ = 0x55;
    *to++ = NUMBER + TIME + COUNT * AXIS_COUNT + CRC;
    to = put_low_first(to, record->number, NUMBER);
    to = put_low_first(to, record->time_fast, TIME);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        to = put_low_first(to, (uint32_t)record->counts[axis], COUNT);
    crc = record_crc(begin, (size_t)(to - begin));
    *to++ = (uint8_t)(crc >> 8);
    *to++ = (uint8_t)crc;
    return to;
}

size_t record_write(uint8_t *bytes, enum record_format format, const struct record *record)
{
    uint8_t *end = bytes;

    switch (format) {
    case RECORD_ASCII:
        end = write_ascii(bytes, record);
        break;
    case RECORD_EXTENDED:
        end = write_extended(bytes, record);
        break;
    default:
        end = write_binary(bytes, record);
        break;
    }
    return (size_t)(end - bytes);
}

static uint8_t *put_word(uint8_t *to, bool low_byte_first, uint16_t word, uint32_t *sum)
{
    *sum += word;
    *to++ = (uint8_t)(low_byte_first ? word : word >> 8);
    *to++ = (uint8_t)(low_byte_first ? word >> 8 : word);
    return to;
}

size_t record_write_packet(uint8_t *bytes, bool low_byte_first, const uint16_t place[3],
                           const struct record *record)
{
    uint8_t *to = bytes;
    uint32_t sum = 0;

    for (unsigned n = 0; n < 3; n++)
        to = put_word(to, low_byte_first, place[n], &sum);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const uint32_t counts = (uint32_t)record->counts[axis];
        const uint16_t upper = (uint16_t)(counts >> 16), lower = (uint16_t)counts;

        to = put_word(to, low_byte_first, low_byte_first ? lower : upper, &sum);
        to = put_word(to, low_byte_first, low_byte_first ? upper : lower, &sum);
    }
    /* In one's complement: what is carried out at the top comes in at the bottom. */
    sum = (sum & 0xffff) + (sum >> 16);
    sum = (sum & 0xffff) + (sum >> 16);
    to = put_word(to, low_byte_first, (uint16_t)~sum, &sum);
    return (size_t)(to - bytes);
}

uint16_t record_crc(const uint8_t *bytes, size_t length)
{
    uint32_t crc = 0xffff;

    for (; length > 0; length--) {
        uint32_t x = (crc >> 8 ^ *bytes++) & 0xff;

        x ^= x >> 4;
        crc = (crc << 8 ^ x << 12 ^ x << 5 ^ x) & 0xffff;
    }
    return (uint16_t)crc;
}
