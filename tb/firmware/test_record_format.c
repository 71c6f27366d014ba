/* SPDX-License-Identifier: BSD-2-Clause */
/* Records, byte for byte. */
#include "check.h"

#include "modules/record_format.h"

static const struct record example = {
    .time_fast = UINT64_C(0x0123456789abcdef),
    .number = 0x1234,
    .address = {24, 25, 26, 27},
    .counts = {45391, 0, 10000, -2},
};

#define CHECK_BYTES(got, length, ...)                                                              \
    do {                                                                                           \
        static const uint8_t wanted[] = {__VA_ARGS__};                                             \
        CHECK_INT(length, sizeof wanted);                                                          \
        for (size_t n = 0; n < sizeof wanted; n++)                                                 \
            CHECK_INT((got)[n], wanted[n]);                                                        \
    } while (0)

/* The example of the original's manual, and a fourth axis. */
TEST(binary_is_that_of_the_original)
{
    uint8_t bytes[RECORD_BYTES_MAX];
    const size_t length = record_write(bytes, RECORD_BINARY, &example);

    CHECK_BYTES(bytes, length, 0x18, 0x4f, 0xb1, 0x00, 0x00, 0x19, 0x00, 0x00, 0x00, 0x00, 0x1a, 0x10,
                0x27, 0x00, 0x00, 0x1b, 0xfe, 0xff, 0xff, 0xff, 0x0d);
}

TEST(text_is_a_line)
{
    char bytes[RECORD_BYTES_MAX + 1] = "";
    struct record lowest = example;

    bytes[record_write((uint8_t *)bytes, RECORD_ASCII, &example)] = '\0';
    CHECK_TEXT(bytes, "X=45391 Y=0 Z=10000 F=-2\r\n");
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++)
        lowest.counts[axis] = INT32_MIN;
    CHECK(record_write((uint8_t *)bytes, RECORD_ASCII, &lowest) <= RECORD_BYTES_MAX);
    CHECK(strncmp(bytes, "X=-2147483648 Y=-2147483648 Z=", 30) == 0);
}

TEST(extended_has_number_time_and_crc)
{
    uint8_t bytes[RECORD_BYTES_MAX];
    const size_t length = record_write(bytes, RECORD_EXTENDED, &example);

    /* The CRC from Python's binascii.crc_hqx(record, 0xffff). */
    CHECK_BYTES(bytes, length, 0xaa, 0x55, 28, 0x34, 0x12, 0xef, 0xcd, 0xab, 0x89, 0x67, 0x45, 0x23,
                0x01, 0x4f, 0xb1, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x10, 0x27, 0x00, 0x00, 0xfe,
                0xff, 0xff, 0xff, 0xfc, 0x62);
    CHECK_INT(record_crc(bytes, length), 0);
}

TEST(crc_is_ccitt_false)
{
    CHECK_INT(record_crc((const uint8_t *)"123456789", 9), 0x29b1); /* of the catalogue of CRCs */
}

/* Sum in one's complement of all words, the checksum among them, complemented. */
static unsigned judged(const uint8_t *bytes, size_t length, bool low_byte_first)
{
    uint32_t sum = 0;

    for (size_t n = 0; n < length; n += 2) {
        sum += low_byte_first ? bytes[n] | (uint32_t)bytes[n + 1] << 8
                              : bytes[n + 1] | (uint32_t)bytes[n] << 8;
        sum = (sum & 0xffff) + (sum >> 16);
    }
    return ~sum & 0xffff;
}

TEST(packets_have_a_checksum_in_either_order_of_bytes)
{
    static const uint16_t place[3] = {0, 0, 0x0102};
    uint8_t bytes[RECORD_BYTES_MAX];
    size_t length = record_write_packet(bytes, false, place, &example);

    /* 0102 + b14f + 2710 + ffff + fffe = 2 d95e, so d960; its complement 269f. */
    CHECK_BYTES(bytes, length, 0, 0, 0, 0, 0x01, 0x02, 0, 0, 0xb1, 0x4f, 0, 0, 0, 0, 0, 0, 0x27, 0x10,
                0xff, 0xff, 0xff, 0xfe, 0x26, 0x9f);
    CHECK_INT(judged(bytes, length, false), 0);
    length = record_write_packet(bytes, true, place, &example);
    CHECK_BYTES(bytes, length, 0, 0, 0, 0, 0x02, 0x01, 0x4f, 0xb1, 0, 0, 0, 0, 0, 0, 0x10, 0x27, 0, 0,
                0xfe, 0xff, 0xff, 0xff, 0x9f, 0x26);
    CHECK_INT(judged(bytes, length, true), 0);
}

TEST_MAIN(RUN(binary_is_that_of_the_original); RUN(text_is_a_line);
          RUN(extended_has_number_time_and_crc); RUN(crc_is_ccitt_false);
          RUN(packets_have_a_checksum_in_either_order_of_bytes))
