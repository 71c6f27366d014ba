/* SPDX-License-Identifier: BSD-2-Clause */
/* The driver of the flash over its registers, and behind them the flash of the board model. */
#include "check.h"

#include <stdlib.h>

#include "../board/nor.h"
#include "hal/flash_map.h"
#include "host/mmio.h"
#include "random.h"
#include "regs.h"

enum {
    PAGE_PROGRAM = 0x02, READ = 0x03, READ_STATUS = 0x05, SECTOR_ERASE = 0x20, READ_ID = 0x9f,
    MS = 1000, US = 1,
    FREE = 0x600000, /* an address that nothing guards */
};

static uint8_t contents[NOR_BYTES], bytes[3 * 65536], back[sizeof bytes];
static struct nor nor;

/* The gateware's part, a frame at a time: docs/blocks/flash.md. */
static struct {
    int64_t now_ps;
    bool fitted, under_way, refused, never_ready;
    uint32_t opcode, left, lowest, frames;
    uint8_t size_bits; /* what the identification says instead; 0: the flash's own */
} ports;

static uint8_t exchange(uint32_t byte)
{
    const uint8_t answer = ports.fitted ? nor_exchange(&nor, ports.now_ps, (uint8_t)byte) : 0xff;

    ports.now_ps += 650000;
    return answer;
}

static void end_frame(void)
{
    if (ports.under_way && ports.fitted)
        nor_deselect(&nor, ports.now_ps);
    ports.under_way = false;
}

static void begin_frame(uint32_t frame)
{
    const uint32_t address = mmio_model_get(REG_FLASH_ADDRESS), opcode = frame & 0xff;
    const bool changes = opcode == PAGE_PROGRAM || opcode == SECTOR_ERASE;

    ports.refused = ports.under_way || (changes && (address < ports.lowest || address >= 0xfff000));
    if (ports.refused)
        return;
    ports.under_way = true;
    ports.opcode = opcode;
    ports.left = frame >> 8;
    ports.frames++;
    if (ports.fitted)
        nor_select(&nor, ports.now_ps);
    (void)exchange(opcode);
    if (changes || opcode == READ) {
        (void)exchange(address >> 16);
        (void)exchange(address >> 8);
        (void)exchange(address);
    }
    if (ports.left == 0)
        end_frame();
}

static uint32_t read_register(void *context, uintptr_t address)
{
    uint32_t word = 0;

    (void)context;
    ports.now_ps += 100000;
    switch (address) {
    case REG_TIMER_COUNT:
        return (uint32_t)(ports.now_ps / 20000);
    case REG_FLASH_STATUS:
        return (ports.under_way ? REG_FLASH_STATUS_BUSY_MASK : 0) |
               (ports.under_way && !ports.never_ready ? REG_FLASH_STATUS_READY_MASK : 0) |
               (ports.refused ? REG_FLASH_STATUS_REFUSED_MASK : 0);
    case REG_FLASH_DATA:
        for (unsigned lane = 0; lane < 4 && ports.left > 0; lane++, ports.left--) {
            const uint8_t byte = exchange(0);
            const bool is_size = ports.opcode == READ_ID && ports.left == 1 && ports.size_bits != 0;

            word |= (uint32_t)(is_size ? ports.size_bits : byte) << 8 * lane;
        }
        if (ports.left == 0)
            end_frame();
        return word;
    default:
        return mmio_model_get(address);
    }
}

static void write_register(void *context, uintptr_t address, uint32_t value)
{
    (void)context;
    ports.now_ps += 60000;
    switch (address) {
    case REG_FLASH_FRAME:
        begin_frame(value);
        break;
    case REG_FLASH_DATA:
        for (unsigned lane = 0; lane < 4 && ports.left > 0; lane++, ports.left--)
            (void)exchange(value >> 8 * lane);
        if (ports.left == 0)
            end_frame();
        break;
    case REG_FLASH_CONTROL:
        if ((value & REG_FLASH_CONTROL_ABORT_MASK) != 0)
            end_frame();
        if ((value & REG_FLASH_CONTROL_LOCK_MASK) != 0)
            ports.lowest = 0x400000;
        break;
    default:
        mmio_model_set(address, value);
    }
}

static void power_up(bool fitted)
{
    memset(contents, 0xff, sizeof contents);
    nor_init(&nor, contents);
    memset(&ports, 0, sizeof ports);
    ports.fitted = fitted;
    ports.lowest = 0x3fe000;
    mmio_model_reset();
    mmio_model_hook((struct mmio_hook){REG_FLASH_DATA, REG_FLASH_GUARD, read_register, write_register, NULL});
    mmio_model_hook((struct mmio_hook){REG_TIMER_COUNT, REG_TIMER_COUNT, read_register, NULL, NULL});
    flash_on_wait(NULL);
}

static int64_t since_us(int64_t begin_ps)
{
    return (ports.now_ps - begin_ps) / 1000000;
}

static void make_bytes(size_t size)
{
    for (size_t n = 0; n < size; n++)
        bytes[n] = (uint8_t)random_below(256);
}

TEST(without_a_flash_that_is_known_at_once)
{
    power_up(false);
    CHECK(!flash_present());
    CHECK(since_us(0) < 20 * US);
    CHECK(!flash_read(FREE, back, 1) && !flash_program(FREE, bytes, 1) && !flash_erase(FREE));
}

TEST(a_flash_in_which_addresses_would_wrap_is_none)
{
    power_up(true);
    for (unsigned bits = 1; bits < 256; bits++) {
        ports.size_bits = (uint8_t)bits;
        CHECK_INT(flash_present(), bits >= 24 && bits <= 32);
    }
}

TEST(what_is_programmed_is_there_and_nothing_else)
{
    static const uint32_t sizes[] = {0, 1, 2, 3, 4, 5, 255, 256, 257, 700};

    power_up(true);
    CHECK(flash_present());
    for (unsigned n = 0; n < 100; n++) {
        const uint32_t size = sizes[random_below(sizeof sizes / sizeof *sizes)];
        const uint32_t address = FREE + 1024 * n + random_below(300);

        make_bytes(size);
        CHECK(flash_program(address, bytes, size));
        for (uint32_t at = 0; at < 1024; at++) {
            const uint32_t place = FREE + 1024 * n + at;
            const bool inside = place >= address && place < address + size;

            if (place >= address)
                CHECK_INT(contents[place], inside ? bytes[place - address] : 0xff);
        }
        CHECK(flash_read(address, back, size));
        CHECK(memcmp(back, bytes, size) == 0);
    }
}

TEST(a_sector_is_erased_whatever_byte_of_it_is_named)
{
    power_up(true);
    CHECK(flash_present());
    memset(contents + FREE, 0x5a, 3 * FLASH_SECTOR);
    CHECK(flash_erase(FREE + FLASH_SECTOR + 1234));
    for (uint32_t n = 0; n < 3 * FLASH_SECTOR; n++)
        CHECK_INT(contents[FREE + n], n / FLASH_SECTOR == 1 ? 0xff : 0x5a);
}

TEST(a_reading_is_longer_than_a_frame)
{
    power_up(true);
    CHECK(flash_present());
    make_bytes(sizeof bytes);
    memcpy(contents + 3, bytes, sizeof bytes);
    CHECK(flash_read(3, back, sizeof back));
    CHECK(memcmp(back, bytes, sizeof bytes) == 0);
}

TEST(what_does_not_fit_is_refused)
{
    power_up(true);
    CHECK(flash_present());
    ports.frames = 0;
    CHECK(!flash_read(FLASH_BYTES - 1, back, 2) && !flash_read(UINT32_MAX, back, 2) && !flash_program(1, back, SIZE_MAX));
    CHECK(!flash_erase(FLASH_BYTES));
    CHECK_INT(ports.frames, 0);
    CHECK(flash_read(FLASH_BYTES - 1, back, 1));
}

TEST(what_the_gateware_refuses_is_false)
{
    power_up(true);
    CHECK(flash_present());
    CHECK(!flash_erase(FLASH_MAP_COUNTER - 1) && !flash_program(0, "\0", 1) && !flash_erase(FLASH_BYTES - 1));
    CHECK(flash_erase(FLASH_MAP_COUNTER));
    flash_lock();
    CHECK(!flash_erase(FLASH_MAP_COUNTER) && !flash_program(FLASH_MAP_GUARDED_END - 1, "\0", 1));
    CHECK(flash_erase(FLASH_MAP_GUARDED_END));
}

TEST(a_flash_that_does_not_end_is_given_up)
{
    int64_t begin_ps;

    power_up(true);
    CHECK(flash_present());
    nor.program_ps = INT64_C(9000000000);
    CHECK(flash_program(FREE, "\0", 1));
    nor.program_ps = INT64_C(11000000000);
    begin_ps = ports.now_ps;
    CHECK(!flash_program(FREE, "\0", 1));
    CHECK(since_us(begin_ps) >= 10 * MS && since_us(begin_ps) < 11 * MS);
    ports.now_ps += INT64_C(20000000000);

    nor.erase_ps = INT64_C(900000000000);
    CHECK(flash_erase(FREE));
    nor.erase_ps = INT64_C(1100000000000);
    begin_ps = ports.now_ps;
    CHECK(!flash_erase(FREE));
    CHECK(since_us(begin_ps) >= 1000 * MS && since_us(begin_ps) < 1010 * MS);
}

TEST(a_frame_that_does_not_go_on_is_given_up)
{
    int64_t begin_ps;

    power_up(true);
    CHECK(flash_present());
    ports.never_ready = true;
    begin_ps = ports.now_ps;
    CHECK(!flash_read(FREE, back, 4));
    CHECK(since_us(begin_ps) < 2 * MS);
    CHECK(!ports.under_way);
    CHECK(!flash_program(FREE, "\0", 1));
    ports.never_ready = false;
    CHECK(flash_read(FREE, back, 4));
}

TEST(a_program_before_left_an_erase_and_a_frame_under_way)
{
    static const uint32_t enable = 0x06;

    power_up(true);
    contents[FREE] = 0;
    mmio_model_set(REG_FLASH_ADDRESS, FREE);
    begin_frame(enable);
    begin_frame(SECTOR_ERASE);
    begin_frame(READ_STATUS | 1 << 8);
    CHECK(ports.under_way);
    CHECK(flash_present());
    CHECK(since_us(0) >= 45 * MS);
    CHECK(flash_read(FREE, back, 1));
    CHECK_INT(back[0], 0xff);
}

static unsigned polls;
static bool allowed;

static void poll(void)
{
    polls++;
    allowed |= flash_read(FREE, back, 1) || flash_program(FREE, "\0", 1) || flash_erase(FREE) || flash_present();
}

TEST(others_are_served_in_the_meantime_but_for_the_flash)
{
    power_up(true);
    CHECK(flash_present());
    flash_on_wait(poll);
    polls = 0;
    allowed = false;
    CHECK(flash_erase(FREE));
    CHECK(polls > 1000);
    CHECK(flash_program(FREE + 1, "\0", 1));
    CHECK(!allowed);
    CHECK_INT(contents[FREE], 0xff);
    CHECK_INT(contents[FREE + 1], 0);
    polls = 0;
    flash_on_wait(NULL);
    CHECK(flash_erase(FREE));
    CHECK_INT(polls, 0);
}

TEST_MAIN(RUN(without_a_flash_that_is_known_at_once); RUN(a_flash_in_which_addresses_would_wrap_is_none);
          RUN(what_is_programmed_is_there_and_nothing_else); RUN(a_sector_is_erased_whatever_byte_of_it_is_named);
          RUN(a_reading_is_longer_than_a_frame); RUN(what_does_not_fit_is_refused);
          RUN(what_the_gateware_refuses_is_false); RUN(a_flash_that_does_not_end_is_given_up);
          RUN(a_frame_that_does_not_go_on_is_given_up); RUN(a_program_before_left_an_erase_and_a_frame_under_way);
          RUN(others_are_served_in_the_meantime_but_for_the_flash))
