/* SPDX-License-Identifier: BSD-2-Clause */
/* boot/frame: SMP packets to lines and back. Expected: lines as the smp package of Python writes them. */
#include "boot/frame.h"

#include "check.h"
#include "random.h"

static char sent[4096];
static size_t sent_count;

static void put(uint8_t byte)
{
    sent[sent_count++] = (char)byte;
}

static const char *lines_of(const uint8_t *packet, size_t size)
{
    sent_count = 0;
    frame_send(packet, size, put);
    sent[sent_count] = '\0';
    return sent;
}

/* The packet that these bytes complete, or "(none)". */
static const char *packet_of(struct frame *frame, const char *bytes, size_t count)
{
    static char text[FRAME_PACKET_BYTES + 1];

    strcpy(text, "(none)");
    for (size_t n = 0; n < count; n++) {
        const uint8_t *packet;
        const size_t size = frame_take(frame, (uint8_t)bytes[n], &packet);

        if (size != 0) {
            memcpy(text, packet, size);
            text[size] = '\0';
        }
    }
    return text;
}

#define EXPECT(bytes, packet) CHECK_TEXT(packet_of(&(struct frame){0}, bytes, sizeof(bytes) - 1), packet)

TEST(knows_the_crc)
{
    CHECK_INT(frame_crc(0, (const uint8_t *)"123456789", 9), 0x31c3); /* check value of CRC-16/XMODEM */
}

TEST(sends_what_the_python_package_sends)
{
    CHECK_TEXT(lines_of((const uint8_t *)"Hello, world!", 13), "\x06\x09" "AA9IZWxsbywgd29ybGQhet4=\n");
}

TEST(takes_a_packet_in_one_line_or_many)
{
    EXPECT("\x06\x09" "AA9IZWxsbywgd29ybGQhet4=\n", "Hello, world!");
    EXPECT("\x06\x09" "AA9I\n\x04\x14" "ZWxs\n\x04\x14" "bywg\n\x04\x14" "d29y\n\x04\x14" "bGQh\n\x04\x14" "et4=\n",
           "Hello, world!");
    EXPECT("\x06\x09" "AA9IZWxsbywgd29ybGQhet4=\r\n", "Hello, world!");
}

TEST(drops_what_is_no_packet)
{
    EXPECT("AA9IZWxsbywgd29ybGQhet4=\n", "(none)");
    EXPECT("\x04\x14" "AA9IZWxsbywgd29ybGQhet4=\n", "(none)");     /* continues nothing: the length is not there */
    EXPECT("\x06\x09" "AA9IZWxsbywgd29ybGQhet8=\n", "(none)");     /* CRC */
    EXPECT("\x06\x09" "AA5IZWxsbywgd29ybGQhet4=\n", "(none)");     /* length */
    EXPECT("\x06\x09" "AA9IZWxsbywgd29ybGQ?et4=\n", "(none)");
    EXPECT("\x06\x09" "AA9IZWxsbywgd29ybGQhet4\n", "(none)");
    EXPECT("\x06\x09" "\n", "(none)");
    EXPECT("\x06\x09" "AAA=\n", "(none)");
    EXPECT("\x06\x09" "AAIAAA==\n", "(none)");                     /* an empty packet */
}

TEST(finds_the_next_packet_after_a_broken_one)
{
    EXPECT("\x06\x09" "AA9IZW\x06\x09\n\x06\x06\x09" "AA9IZWxsbywgd29ybGQhet4=\n", "Hello, world!");
    EXPECT("W X\r\x06\x09" "AA9I\n\x06\x09" "AA9IZWxsbywgd29ybGQhet4=\n", "Hello, world!");
}

TEST(gives_back_every_length)
{
    static struct frame frame;
    static uint8_t packet[FRAME_PACKET_BYTES];

    for (size_t size = 1; size <= FRAME_PACKET_BYTES; size++) {
        const uint8_t *got = NULL;
        size_t got_size = 0, longest = 0, line = 0;

        packet[size - 1] = (uint8_t)random_below(256);
        lines_of(packet, size);
        for (size_t n = 0; n < sent_count; n++) {
            line = sent[n] == '\n' ? 0 : line + 1;
            longest = line > longest ? line : longest;
            got_size = frame_take(&frame, (uint8_t)sent[n], &got);
            CHECK(got_size == 0 || n == sent_count - 1);
        }
        CHECK_INT(got_size, size);
        CHECK(memcmp(got, packet, size) == 0);
        CHECK(longest <= 126);
    }
}

TEST(drops_a_packet_that_is_too_long)
{
    static struct frame frame;
    static uint8_t packet[FRAME_PACKET_BYTES + 1];

    lines_of(packet, sizeof packet);
    for (size_t n = 0; n < sent_count; n++)
        CHECK_INT(frame_take(&frame, (uint8_t)sent[n], &(const uint8_t *){NULL}), 0);
}

TEST_MAIN(RUN(knows_the_crc); RUN(sends_what_the_python_package_sends); RUN(takes_a_packet_in_one_line_or_many);
          RUN(drops_what_is_no_packet); RUN(finds_the_next_packet_after_a_broken_one); RUN(gives_back_every_length);
          RUN(drops_a_packet_that_is_too_long))
