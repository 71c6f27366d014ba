/* SPDX-License-Identifier: BSD-2-Clause */
/* The flash of the board model (tb/board/nor.h), by its commands and at its pins; figures are those of the W25Q128JV. */
#include "../board/nor.h"

#include <stdlib.h>
#include <unistd.h>

#include "check.h"

static struct nor nor;
static uint8_t contents[NOR_BYTES];
static int64_t now_ps;

enum { BYTE_PS = 640000, BIT_PS = 80000 }; /* at 12.5 MHz */

static void power_up(void)
{
    memset(contents, 0xff, sizeof contents);
    nor_init(&nor, contents);
    now_ps = 0;
}

/* One selection: bytes to it, and in their place those that came. */
static void frame(uint8_t *bytes, size_t size)
{
    nor_select(&nor, now_ps);
    for (size_t n = 0; n < size; n++) {
        bytes[n] = nor_exchange(&nor, now_ps, bytes[n]);
        now_ps += BYTE_PS;
    }
    nor_deselect(&nor, now_ps);
}

#define FRAME(...)                                                                                 \
    do {                                                                                           \
        uint8_t frame_bytes[] = {__VA_ARGS__};                                                     \
        frame(frame_bytes, sizeof frame_bytes);                                                    \
    } while (0)

static uint8_t status(void)
{
    uint8_t bytes[] = {0x05, 0};

    frame(bytes, sizeof bytes);
    return bytes[1];
}

static uint8_t byte_at(uint32_t address)
{
    uint8_t bytes[] = {0x03, (uint8_t)(address >> 16), (uint8_t)(address >> 8), (uint8_t)address, 0};

    frame(bytes, sizeof bytes);
    return bytes[4];
}

static void wait_ps(int64_t time_ps)
{
    now_ps += time_ps;
    nor_advance(&nor, now_ps);
}

#define PROGRAM(...)                                                                               \
    do {                                                                                           \
        FRAME(0x06);                                                                               \
        FRAME(0x02, __VA_ARGS__);                                                                  \
        wait_ps(INT64_C(1000000000));                                                              \
    } while (0)

TEST(it_says_what_it_is)
{
    uint8_t bytes[] = {0x9f, 0, 0, 0, 0};

    power_up();
    frame(bytes, sizeof bytes);
    CHECK_INT(bytes[0], 0xff);
    CHECK_INT(bytes[1], 0xef);
    CHECK_INT(bytes[2], 0x40);
    CHECK_INT(bytes[3], 0x18);
    CHECK_INT(bytes[4], 0xef);
}

TEST(programming_clears_bits_and_erasing_a_sector_sets_them)
{
    power_up();
    PROGRAM(0x12, 0x3f, 0xff, 0x0f);
    PROGRAM(0x12, 0x30, 0x00, 0xf3);
    PROGRAM(0x12, 0x30, 0x00, 0x3f);
    PROGRAM(0x12, 0x40, 0x00, 0x00);
    CHECK_INT(byte_at(0x123000), 0x33);
    CHECK_INT(byte_at(0x123fff), 0x0f);
    FRAME(0x06);
    FRAME(0x20, 0x12, 0x38, 0x77);
    wait_ps(INT64_C(50000000000));
    CHECK_INT(byte_at(0x123000), 0xff);
    CHECK_INT(byte_at(0x123fff), 0xff);
    CHECK_INT(byte_at(0x124000), 0x00);
}

TEST(reading_goes_on_and_around_the_end)
{
    uint8_t bytes[] = {0x03, 0xff, 0xff, 0xff, 0, 0, 0};

    power_up();
    PROGRAM(0xff, 0xff, 0xff, 1);
    PROGRAM(0, 0, 0, 2, 3);
    frame(bytes, sizeof bytes);
    CHECK_INT(bytes[4], 1);
    CHECK_INT(bytes[5], 2);
    CHECK_INT(bytes[6], 3);
}

TEST(a_page_wraps_and_of_too_many_bytes_the_last_count)
{
    uint8_t long_frame[4 + 258] = {0x02, 0, 2, 0};

    power_up();
    PROGRAM(0, 1, 0xff, 0x11, 0x22);
    CHECK_INT(byte_at(0x1ff), 0x11);
    CHECK_INT(byte_at(0x100), 0x22);
    CHECK_INT(byte_at(0x200), 0xff);
    for (unsigned n = 0; n < 258; n++)
        long_frame[4 + n] = (uint8_t)(n < 256 ? n : 0xf0);
    FRAME(0x06);
    frame(long_frame, sizeof long_frame);
    wait_ps(INT64_C(1000000000));
    CHECK_INT(byte_at(0x200), 0xf0);
    CHECK_INT(byte_at(0x201), 0xf0);
    CHECK_INT(byte_at(0x202), 2);
    CHECK_INT(byte_at(0x2ff), 255);
}

TEST(a_change_needs_write_enable_each_time)
{
    power_up();
    FRAME(0x02, 0, 0, 0, 0);
    CHECK_INT(status(), 0);
    CHECK_INT(byte_at(0), 0xff);
    FRAME(0x06);
    CHECK_INT(status(), 2);
    FRAME(0x04);
    CHECK_INT(status(), 0);
    PROGRAM(0, 0, 0, 0x5a);
    CHECK_INT(status(), 0);
    FRAME(0x20, 0, 0, 0);
    CHECK_INT(status(), 0);
    CHECK_INT(byte_at(0), 0x5a);
}

TEST(frames_that_end_elsewhere_and_other_commands_change_nothing)
{
    power_up();
    PROGRAM(0, 0, 0, 0x5a);
    FRAME(0x06, 0);
    CHECK_INT(status(), 0);
    FRAME(0x06);
    FRAME(0x20, 0, 0);
    FRAME(0x20, 0, 0, 0, 0);
    FRAME(0x02, 0, 0, 1);
    FRAME(0xc7);
    FRAME(0xd8, 0, 0, 0);
    FRAME(0xab);
    CHECK_INT(status(), 2);
    CHECK_INT(byte_at(0), 0x5a);
    CHECK_INT(byte_at(1), 0xff);
}

TEST(a_change_takes_its_time_and_only_the_status_answers_meanwhile)
{
    power_up();
    FRAME(0x06);
    FRAME(0x02, 0, 0, 0, 0x5a);
    const int64_t programmed_ps = now_ps;
    CHECK_INT(status(), 3);
    CHECK_INT(byte_at(0), 0xff);
    FRAME(0x06);
    FRAME(0x02, 0, 0, 1, 0);
    while (status() & 1)
        ;
    CHECK(now_ps - programmed_ps >= INT64_C(700000000) && now_ps - programmed_ps < INT64_C(702000000));
    CHECK_INT(status(), 0);
    CHECK_INT(byte_at(0), 0x5a);
    CHECK_INT(byte_at(1), 0xff);
    FRAME(0x06);
    FRAME(0x20, 0, 0, 0);
    const int64_t erased_ps = now_ps;
    while (status() & 1)
        ;
    CHECK(now_ps - erased_ps >= INT64_C(45000000000) && now_ps - erased_ps < INT64_C(45002000000));
}

TEST(one_status_frame_sees_it_end)
{
    uint8_t bytes[] = {0x05, 0, 0, 0, 0};

    power_up();
    nor.program_ps = 3 * BYTE_PS - 1;
    FRAME(0x06);
    FRAME(0x02, 0, 0, 0, 0);
    frame(bytes, sizeof bytes);
    CHECK_INT(bytes[1], 3);
    CHECK_INT(bytes[2], 3);
    CHECK_INT(bytes[3], 0);
}

/* --- Power cuts --------------------------------------------------------------------------------------------- */

/* A page of 0 over 0xf0, cut after a part of its time. */
static void cut_program(int64_t after_ps, uint32_t seed)
{
    uint8_t bytes[4 + NOR_PAGE] = {0x02, 0, 0, 0};

    power_up();
    memset(contents, 0xf0, NOR_PAGE);
    FRAME(0x06);
    frame(bytes, sizeof bytes);
    wait_ps(after_ps);
    nor_cut(&nor, seed);
}

TEST(a_cut_leaves_some_bits_of_a_page_changed)
{
    unsigned least = NOR_PAGE * 4, most = 0, mixed = 0;

    for (uint32_t seed = 1; seed < 200; seed++) {
        unsigned changed = 0;

        cut_program(INT64_C(350000000), seed);
        for (unsigned n = 0; n < NOR_PAGE; n++) {
            CHECK_INT(contents[n] & 0x0f, 0);
            changed += (unsigned)__builtin_popcount(0xf0u & ~contents[n]);
            mixed += contents[n] != 0 && contents[n] != 0xf0;
        }
        least = changed < least ? changed : least;
        most = changed > most ? changed : most;
        CHECK_INT(contents[NOR_PAGE], 0xff);
        CHECK_INT(status(), 0);
        wait_ps(INT64_C(1000000000));
        CHECK_INT(contents[255] & 0x0f, 0);
    }
    /* Half of the bits, more or less. */
    CHECK(least > 400 && most < 620 && most > least && mixed > 1000);
}

TEST(a_cut_at_the_begin_or_the_end_leaves_little_or_nearly_all)
{
    unsigned changed = 0;

    for (uint32_t seed = 1; seed < 50; seed++) {
        cut_program(0, seed);
        for (unsigned n = 0; n < NOR_PAGE; n++)
            changed += (unsigned)__builtin_popcount(0xf0u & ~contents[n]);
    }
    CHECK(changed < 49 * 20);
    changed = 0;
    for (uint32_t seed = 1; seed < 50; seed++) {
        cut_program(INT64_C(699000000), seed);
        for (unsigned n = 0; n < NOR_PAGE; n++)
            changed += (unsigned)__builtin_popcount(contents[n]);
    }
    CHECK(changed < 49 * 20);
}

/* Of 1000 readings of a 0 in a sector whose erase was cut then, those that have a 1. */
static unsigned ones_after(int64_t after_ps)
{
    unsigned ones = 0;

    power_up();
    memset(contents, 0, 2 * NOR_SECTOR);
    FRAME(0x06);
    FRAME(0x20, 0, 0, 0);
    wait_ps(after_ps);
    nor_cut(&nor, 7);
    for (unsigned n = 0; n < 1000; n++)
        ones += byte_at(77) & 1;
    return ones;
}

TEST(a_sector_whose_erase_was_cut_reads_unstably_until_it_is_erased)
{
    const unsigned begin = ones_after(0), middle = ones_after(INT64_C(22000000000));

    CHECK(begin > 0 && begin < 100 && middle > 100 && middle < 900);
    CHECK_INT(byte_at(NOR_SECTOR), 0);
    FRAME(0x06);
    FRAME(0x20, 0, 0, 0);
    wait_ps(INT64_C(50000000000));
    PROGRAM(0, 0, 77, 0);
    for (unsigned n = 0; n < 100; n++)
        CHECK_INT(byte_at(77), 0);
    CHECK_INT(byte_at(78), 0xff);
}

TEST(a_cut_loses_write_enable_and_the_frame_under_way)
{
    power_up();
    FRAME(0x06);
    nor_select(&nor, now_ps);
    for (unsigned n = 0; n < 5; n++)
        (void)nor_exchange(&nor, now_ps, n == 0 ? 0x02 : 0);
    nor_cut(&nor, 1);
    nor_deselect(&nor, now_ps);
    CHECK_INT(status(), 0);
    CHECK_INT(byte_at(0), 0xff);
    FRAME(0x02, 0, 0, 0, 0);
    CHECK_INT(status(), 0);
}

/* --- Pins --------------------------------------------------------------------------------------------------- */

/* A selection at the pins, `bits` long, with MISO taken as the clock rises. */
static void pins(uint8_t *bytes, size_t bits)
{
    (void)nor_pins(&nor, now_ps, 0, 0, 0);
    for (size_t n = 0; n < bits; n++) {
        const unsigned shift = 7 - n % 8;
        const int mosi = bytes[n / 8] >> shift & 1;
        int miso;

        now_ps += BIT_PS / 2;
        miso = nor_pins(&nor, now_ps, 0, 0, mosi);
        (void)nor_pins(&nor, now_ps, 0, 1, mosi);
        bytes[n / 8] = (uint8_t)((bytes[n / 8] & ~(1u << shift)) | (unsigned)miso << shift);
        now_ps += BIT_PS / 2;
        (void)nor_pins(&nor, now_ps, 0, 0, mosi);
    }
    (void)nor_pins(&nor, now_ps, 1, 0, 1);
}

#define PINS(...)                                                                                  \
    do {                                                                                           \
        uint8_t pins_bytes[] = {__VA_ARGS__};                                                      \
        pins(pins_bytes, 8 * sizeof pins_bytes);                                                   \
    } while (0)

TEST(the_same_at_its_pins)
{
    uint8_t identification[] = {0x9f, 0, 0, 0}, read[] = {0x03, 0, 1, 0, 0x55, 0x55, 0x55}, state[] = {0x05, 0, 0};

    power_up();
    CHECK_INT(nor_pins(&nor, 0, 1, 0, 0), 1);
    pins(identification, 32);
    CHECK_INT(identification[0], 0xff);
    CHECK_INT(identification[1], 0xef);
    CHECK_INT(identification[2], 0x40);
    CHECK_INT(identification[3], 0x18);
    PINS(0x06);
    PINS(0x02, 0, 1, 0, 0xa5, 0x3c);
    pins(state, 24);
    CHECK_INT(state[2], 3);
    wait_ps(INT64_C(1000000000));
    pins(read, 56);
    CHECK_INT(read[3], 0xff);
    CHECK_INT(read[4], 0xa5);
    CHECK_INT(read[5], 0x3c);
    CHECK_INT(read[6], 0xff);
}

TEST(a_selection_that_ends_within_a_byte_changes_nothing)
{
    uint8_t enable[] = {0x06, 0}, program[] = {0x02, 0, 0, 0, 0, 0};

    power_up();
    pins(enable, 9);
    CHECK_INT(status(), 0);
    FRAME(0x06);
    pins(program, 41);
    pins(program, 4);
    CHECK_INT(status(), 2);
    CHECK_INT(byte_at(0), 0xff);
}

TEST(contents_live_in_a_file)
{
    char path[] = "/tmp/norXXXXXX";
    const int file = mkstemp(path);
    uint8_t *bytes;

    CHECK(file >= 0);
    bytes = nor_map(path);
    CHECK(bytes != NULL && bytes[0] == 0xff && bytes[NOR_BYTES - 1] == 0xff);
    nor_init(&nor, bytes);
    now_ps = 0;
    PROGRAM(0, 0, 5, 0x5a);
    bytes = nor_map(path);
    CHECK(bytes != NULL && bytes[5] == 0x5a && bytes[4] == 0xff);
    CHECK_INT(ftruncate(file, 5000), 0);
    CHECK(nor_map(path) == NULL);
    close(file);
    unlink(path);
    CHECK(nor_map("/no/such/place") == NULL);
    bytes = nor_map(NULL);
    CHECK(bytes != NULL && bytes[77] == 0xff);
}

TEST_MAIN(RUN(it_says_what_it_is); RUN(programming_clears_bits_and_erasing_a_sector_sets_them);
          RUN(reading_goes_on_and_around_the_end); RUN(a_page_wraps_and_of_too_many_bytes_the_last_count);
          RUN(a_change_needs_write_enable_each_time); RUN(frames_that_end_elsewhere_and_other_commands_change_nothing);
          RUN(a_change_takes_its_time_and_only_the_status_answers_meanwhile); RUN(one_status_frame_sees_it_end);
          RUN(a_cut_leaves_some_bits_of_a_page_changed); RUN(a_cut_at_the_begin_or_the_end_leaves_little_or_nearly_all);
          RUN(a_sector_whose_erase_was_cut_reads_unstably_until_it_is_erased);
          RUN(a_cut_loses_write_enable_and_the_frame_under_way); RUN(the_same_at_its_pins);
          RUN(a_selection_that_ends_within_a_byte_changes_nothing); RUN(contents_live_in_a_file))
